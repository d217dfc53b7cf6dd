# SPDX-License-Identifier: GPL-3.0-or-later
"""The Lamina panel in the Material tab: what is shown, presets, Layers, Below."""

import bpy

from ..base import editable, native
from ..editing import depth, layer_list, over_material
from ..properties import migration
from ..properties.layer_properties import LAYER_KINDS
from ..settling import dust_job
from . import fields, preset_picker, state_line
from .material_panel import EEVEE, AnyMaterialPanel, MaterialPanel
from .sentences import characters, draw_progress, draw_sentence

SWATCHES = {"optical": "albedo", "colour": "colour"}
ICONS = {kind: icon for kind, _name, _description, icon, _number in LAYER_KINDS}


class LAMINA_UL_layers(bpy.types.UIList):
    """Top layer first, in the order of light: kind, name, thickness or index, colour."""

    error = None  # the row with an error; the panel sets it before it draws the list

    def draw_item(self, _context, layout, _data, layer, _icon, _active, _property, index=0):
        row = layout.row(align=True)
        icon = "ERROR" if self.error == index else ICONS[layer.kind]
        row.prop(layer, "name", text="", emboss=False, icon=icon)
        facts = row.row(align=True)
        facts.alignment = "RIGHT"
        facts.label(text=fields.facts(layer), icon="TEXTURE" if layer.varying else "NONE")
        if layer.kind == "medium" and layer.mode in SWATCHES:
            row.separator(factor=0.5)
            swatch = row.row(align=True)
            swatch.ui_units_x = 1.2
            swatch.prop(layer, SWATCHES[layer.mode], text="")


class LAMINA_PT_top(AnyMaterialPanel, bpy.types.Panel):
    """An empty panel without a header, which Blender draws above Surface. Its subpanel can be folded."""

    bl_label = "Lamina"
    bl_options = {"HIDE_HEADER"}

    def draw(self, _context):
        pass


class LAMINA_PT_main(AnyMaterialPanel, bpy.types.Panel):
    bl_label = "Lamina"
    bl_parent_id = "LAMINA_PT_top"

    def draw(self, context):
        layout, material = self.layout, context.material
        if not native.available():
            draw_sentence(context, layout, native.reason(), "ERROR")
        if context.engine in EEVEE:
            row = layout.row()
            row.label(text="Cycles shows all of it", icon="INFO")
            row.prop_enum(context.scene.render, "engine", "CYCLES", text="Switch to Cycles")
        if migration.is_from_the_future(material):
            draw_sentence(context, layout, "Made by a newer version of Lamina: update Lamina to edit it")
        elif not editable.is_editable(material):
            draw_sentence(context, layout, f"This is {editable.problem(material)}", "LINKED")
        elif not material.lamina.enabled:
            _draw_start(context, layout, material)
        else:
            state_line.draw(context, layout, material)
            _draw_presets(context, layout, folded=True)


class LAMINA_PT_layers(MaterialPanel, bpy.types.Panel):
    bl_label = "Layers"
    bl_parent_id = "LAMINA_PT_main"

    def draw(self, context):
        layout, material = self.layout, context.material
        settings = material.lamina
        layout.active = editable.is_editable(material)
        LAMINA_UL_layers.error = state_line.error_layer(material)
        row = layout.row()
        row.template_list("LAMINA_UL_layers", "", settings, "layers", settings, "active_index", rows=3)
        column = row.column(align=True)
        column.operator_menu_enum("lamina.layer_add", "kind", text="", icon="ADD")
        column.operator("lamina.layer_remove", text="", icon="REMOVE")
        column.separator()
        column.menu("LAMINA_MT_stack", text="", icon="DOWNARROW_HLT")
        column.separator()
        column.operator("lamina.layer_move", text="", icon="TRIA_UP").direction = "UP"
        column.operator("lamina.layer_move", text="", icon="TRIA_DOWN").direction = "DOWN"
        layer = layer_list.active_layer(material)
        if not depth.shows_layers(material):
            draw_sentence(context, layout, "Veins shows two materials of its own in place of these layers")
        elif layer is not None:
            fields.draw_layer(layout, layer)


class LAMINA_PT_base(MaterialPanel, bpy.types.Panel):
    bl_label = "Below"
    bl_parent_id = "LAMINA_PT_main"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def wanted(cls, material):
        return super().wanted(material) and depth.shows_layers(material)

    def draw_header_preset(self, context):
        base = context.material.lamina.base
        icon = "INFO" if over_material.has_changed(context.material) else "NONE"  # the sentence may be folded
        self.layout.label(text=base.bl_rna.properties["kind"].enum_items[base.kind].name, icon=icon)

    def draw(self, context):
        layout, material = self.layout, context.material
        layout.active = editable.is_editable(material)
        fields.draw_base(layout, material.lamina.base)
        if over_material.has_changed(material):
            text = "The shader in the frame Before Lamina was edited: the layers do not show that yet"
            draw_sentence(context, layout, text)
            layout.operator("lamina.read_again", icon="FILE_REFRESH")
        ior = layer_list.open_ior(material)
        if ior is not None:
            text = f"The sheet ends inside a dielectric of IOR {ior:.3g}: it has no back surface"
            draw_sentence(context, layout, text)
            layout.operator("lamina.sheet_close", icon="ADD")


def _draw_start(context, layout, material):
    """The choice between dust, layers over the material as it is, and a new material."""
    job = dust_job.running()
    if job is not None:
        draw_progress(layout, job, "DUST")
    else:
        row = layout.row()
        row.scale_y = 1.4
        row.operator("lamina.dust_objects", icon="FORCE_FORCE")
    if not over_material.problem(material):
        row = layout.row()
        row.scale_y = 1.4
        row.operator("lamina.add_over", icon="ADD")
        column = layout.column(align=True)
        for text, icon in over_material.told(material, characters(context)):
            column.label(text=text, icon=icon)
        layout.row().operator("lamina.add_stack", text="New Layers Instead")
    else:
        layout.operator("lamina.add_stack", icon="ADD")
    _draw_presets(context, layout, folded=False)


def _draw_presets(context, layout, folded):
    """The menu of presets, and all presets by picture."""
    layout.menu("LAMINA_MT_presets", icon="PRESET")
    header, body = layout.panel(f"lamina_pictures_{folded:d}", default_closed=folded)
    header.label(text="Presets by Picture")
    if body is not None:
        preset_picker.draw(body, context)
        if refusal := preset_picker.refusal(context.material):
            draw_sentence(context, body, refusal, "ERROR", alert=True)


CLASSES = (
    LAMINA_UL_layers,
    LAMINA_PT_top,
    LAMINA_PT_main,
    LAMINA_PT_layers,
    LAMINA_PT_base,
)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
