# SPDX-License-Identifier: GPL-3.0-or-later
"""The Lamina panel in the Material tab: presets, Layers, Base, Bake, Result."""

import math

import bpy

from ..baking import bake_job
from ..base import messages, native
from ..base.messages import percent
from ..editing import layer_list, over_material, stack_io
from ..nodes import node_group
from ..properties import migration
from ..properties.layer_properties import LAYER_KINDS
from ..settling import dust_job
from ..stack_json import solved_colours, stack_check
from . import fields, preset_picker, result_picture

CHANNELS = ("red", "green", "blue")
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


class MaterialPanel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "material"
    COMPAT_ENGINES = {"CYCLES"}

    @classmethod
    def poll(cls, context):
        if context.material is None or context.engine not in cls.COMPAT_ENGINES:
            return False
        return cls.wanted(context.material)

    @classmethod
    def wanted(cls, material):
        return material.lamina.enabled and not migration.is_from_the_future(material)


class AnyMaterialPanel(MaterialPanel):
    """A panel of materials without layers, too."""

    @classmethod
    def wanted(cls, material):
        return material.grease_pencil is None


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
        if migration.is_from_the_future(material):
            draw_sentence(context, layout, "Made by a newer version of Lamina: update Lamina to edit it")
        elif not material.is_editable:
            draw_sentence(context, layout, "Linked from another file: edit the layers there", "LINKED")
        elif not material.lamina.enabled:
            _draw_start(context, layout, material)
        else:
            _draw_presets(context, layout, folded=True)


class LAMINA_PT_layers(MaterialPanel, bpy.types.Panel):
    bl_label = "Layers"
    bl_parent_id = "LAMINA_PT_main"

    def draw(self, context):
        layout, material = self.layout, context.material
        settings = material.lamina
        layout.active = material.is_editable
        LAMINA_UL_layers.error = _error_layer(material)
        row = layout.row()
        row.template_list("LAMINA_UL_layers", "", settings, "layers", settings, "active_index", rows=5)
        column = row.column(align=True)
        column.operator_menu_enum("lamina.layer_add", "kind", text="", icon="ADD")
        column.operator("lamina.layer_remove", text="", icon="REMOVE")
        column.separator()
        column.menu("LAMINA_MT_stack", text="", icon="DOWNARROW_HLT")
        column.separator()
        column.operator("lamina.layer_move", text="", icon="TRIA_UP").direction = "UP"
        column.operator("lamina.layer_move", text="", icon="TRIA_DOWN").direction = "DOWN"
        layer = layer_list.active_layer(material)
        if layer is not None:
            fields.draw_layer(layout, layer)


class LAMINA_PT_base(MaterialPanel, bpy.types.Panel):
    bl_label = "Base"
    bl_parent_id = "LAMINA_PT_main"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header_preset(self, context):
        base = context.material.lamina.base
        icon = "INFO" if over_material.has_changed(context.material) else "NONE"  # the sentence may be folded
        self.layout.label(text=base.bl_rna.properties["kind"].enum_items[base.kind].name, icon=icon)

    def draw(self, context):
        layout, material = self.layout, context.material
        layout.active = material.is_editable
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


class LAMINA_PT_bake(MaterialPanel, bpy.types.Panel):
    bl_label = "Bake"
    bl_parent_id = "LAMINA_PT_main"

    def draw(self, context):
        layout, material = self.layout, context.material
        row = layout.row()
        row.prop(material.lamina, "quality", expand=True)
        row.prop(material.lamina, "live", toggle=True, icon="PLAY" if not material.lamina.live else "PAUSE")
        row = layout.row(heading="Fit")
        row.prop(material.lamina, "basis", expand=True)
        job = bake_job.running_for(material)
        if job is not None:
            draw_progress(layout, job, "BAKE")
            return
        row = layout.row()
        row.scale_y = 1.4
        row.operator("lamina.bake", text=_bake_label(material), icon="RENDER_STILL")
        failure = bake_job.failure(material) or _stack_error(material)
        if failure:
            draw_sentence(context, layout, failure, "ERROR", alert=True)


class LAMINA_PT_result(MaterialPanel, bpy.types.Panel):
    bl_label = "Result"
    bl_parent_id = "LAMINA_PT_main"

    @classmethod
    def wanted(cls, material):
        return super().wanted(material) and bool(material.lamina.result.stack_hash)

    def draw(self, context):
        layout, material = self.layout, context.material
        _draw_state(layout, context, material)
        if node_group.shows_lateral(material):
            text = "The output shows the panel Lateral or Interior instead of this bake"
            draw_sentence(context, layout, text)
        elif material.lamina.node_group is not None and not node_group.is_connected(material):
            row = layout.row()
            row.label(text="Not connected to the output", icon="UNLINKED")
            row.operator("lamina.connect", text="Connect")
        result = material.lamina.result
        if not result_picture.draw(layout, context, material):  # a bake of an earlier version
            draw_lines(layout, [*result_lines(result), *below_lines(result)])
            return
        draw_lines(layout, below_lines(result))
        header, body = layout.panel("lamina_numbers", default_closed=True)
        fit_error = result.report.get("fit_error")
        header.label(text="Numbers" if fit_error is None else f"Numbers (fit error {percent(fit_error)})")
        if body is not None:
            draw_lines(body, result_lines(result))


def draw_lines(layout, lines):
    """A column of (name, value)."""
    column = layout.column(align=True)
    for name, value in lines:
        split = column.split(factor=0.4)
        label = split.row()
        label.alignment = "RIGHT"
        label.label(text=name)
        split.label(text=value)


def below_lines(result):
    """(name, value) of the lines on a base that another shader renders, whose light is approximate."""
    errors = result.report.get("base_error")
    if not errors:
        return []
    return [
        ("Shader Below", "Approximate. Error of the energy:"),
        ("If Matte", percent(errors["lambert"])),
        ("If Rough Metal", percent(errors["metal"])),
        ("In One Channel", percent(errors["color"])),
        ("Without Reflectance", percent(errors["unknown"])),
    ]


def result_lines(result):
    """(name, value) for each of the result's numbers."""
    report = result.report
    if not report:  # of an earlier version, in a linked file
        return [("Numbers", "Bake again: an earlier Lamina made this bake")]
    lines = []
    for name, ending in (("Fit Error", ""), ("Transmission", "_transmission")):
        mean, worst = report[f"fit_error{ending}"], report.get(f"worst_slice{ending}")
        if mean is not None:
            text = f"{percent(mean)} mean"
            lines.append((name, f"{text}, {percent(worst['error'])} worst" if worst else text))
        if worst:
            lines.append(("Worst At", _place(worst, report["tau_rows"] > 1)))
    lines.append(("Albedo Error", percent(report["albedo_error"], 2)))
    inputs = report.get("input_error")
    if inputs:
        errors = percent(inputs["mean"]), percent(inputs["worst"]["error"])
        lines.append(("Over All Inputs", f"{errors[0]} mean, {errors[1]} worst"))
        lines.append(("Their Albedo Error", percent(inputs["albedo"]["error"], 2)))
    lines.append(("Energy Error", percent(report["energy_error"], 2)))
    lines.append(("Closures", f"{report['closures']}, {result.basis or 'standard'} fit"))
    lines.append(("Baked", f"{result.quality.capitalize()}, {report['seconds']:.2f} s"))
    return lines


def _place(worst, varies):
    """The place of a worst slice; its thickness if a layer varies."""
    angle = math.degrees(math.acos(worst["mu_o"]))
    place = [f"{angle:.0f}° view", CHANNELS[worst["channel"]]]
    if worst["side"] == "bottom":
        place.append("back side")
    if varies:
        place.append(f"thickness {worst['tau']:.2g}")
    return ", ".join(place)


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
        for text, icon in over_material.told(material, _characters(context)):
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


def draw_progress(layout, job, work):
    """A worker's progress bar, and the operator that cancels `work`, an item of that operator."""
    row = layout.row(align=True)
    row.scale_y = 1.4
    text = "Cancelling" if job.cancelling else f"{job.fraction:.0%}  {job.text}"
    row.progress(factor=job.fraction, text=text)
    row.operator("lamina.cancel", text="", icon="CANCEL").work = work


def _draw_state(layout, context, material):
    state = "unknown"
    if native.available():
        state = bake_job.state(material) if _is_checked(material) else "stale"
    if state == "fresh":
        layout.label(text="Up to date", icon="CHECKMARK")
    elif state == "stale":
        layout.label(text="Out of date: the layers have changed", icon="FILE_REFRESH")
    elif state == "live":
        chosen = f"{material.lamina.quality.capitalize()}, {material.lamina.basis.capitalize()}"
        draw_sentence(context, layout, f"Live preview of these layers; Bake makes {chosen}", "PLAY")
    elif state == "other":
        text = f"Out of date: baked with {bake_job.difference(material)}"
        draw_sentence(context, layout, text, "FILE_REFRESH")
    elif state == "older":
        text = f"Out of date: {bake_job.version_difference(material)}"
        draw_sentence(context, layout, text, "FILE_REFRESH")
    elif state == "invalid":
        draw_sentence(context, layout, "Out of date: the layers cannot be baked as they are", "ERROR")
    elif state == "none":
        draw_sentence(context, layout, "The node group of the last bake is gone: bake again", "ERROR")


def _bake_label(material):
    return "Bake Again" if material.lamina.result.stack_hash else "Bake"


def _is_checked(material):
    """True if the stack can be checked while the panel is drawn. If not, the panel is drawn again later."""
    return solved_colours.is_checked(material, stack_io.to_text(material))


def _error(material):
    """The error in the layers as they are now, or None."""
    if not native.available() or not _is_checked(material):
        return None
    return stack_check.of(stack_io.to_text(material))[1]


def _stack_error(material):
    """The fault in the layers as they are now, as a sentence, or ''."""
    error = _error(material)
    return "" if error is None else messages.sentence(error, material)


def _error_layer(material):
    """Index of the layer with the stack's error, or None."""
    error = _error(material)
    return None if error is None else messages.layer_index(str(error))


def draw_sentence(context, layout, text, icon="INFO", alert=False):
    """A sentence, wrapped to the panel's width."""
    column = layout.column(align=True)
    column.alert = alert
    for number, line in enumerate(messages.wrapped(text, _characters(context))):
        column.label(text=line, icon=icon if number == 0 else "BLANK1")


def _characters(context):
    """The number of characters that fit into a line of the panel, beside an icon."""
    scale = context.preferences.system.ui_scale
    return max(int((context.region.width / scale - 70.0) / 6.4), 20)


CLASSES = (
    LAMINA_UL_layers,
    LAMINA_PT_top,
    LAMINA_PT_main,
    LAMINA_PT_layers,
    LAMINA_PT_base,
    LAMINA_PT_bake,
    LAMINA_PT_result,
)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
