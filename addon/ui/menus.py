# SPDX-License-Identifier: GPL-3.0-or-later
"""The menus of the panel: presets, metals, and actions for the complete stack."""

import bpy

from ..base import messages, native
from ..editing import metals, presets
from . import preset_picker

TALLEST = 30  # number of menu rows that fit on small screens


class LAMINA_MT_stack(bpy.types.Menu):
    bl_label = "Layer Stack"

    def draw(self, _context):
        layout = self.layout
        layout.operator("lamina.layer_duplicate", icon="DUPLICATE")
        layout.separator()
        layout.operator("lamina.stack_import", text="Import Stack...", icon="IMPORT")
        layout.operator("lamina.stack_export", text="Export Stack...", icon="EXPORT")
        layout.operator("lamina.match_measurement", text="Match Measurement...", icon="EYEDROPPER")
        layout.separator()
        layout.operator("lamina.remove_stack", icon="X")


class LAMINA_MT_presets(bpy.types.Menu):
    """The user's own presets, then the library by category, in columns of similar height. Presets that the
    material cannot take are gray; their tooltips say why."""

    bl_label = "Presets"
    bl_description = "Replace the layers by those of a ready-made material"

    def draw(self, context):
        columns, material = self.layout.row(), getattr(context, "material", None)
        over = "ALL" if material is None else preset_picker.over(material)
        column, height = columns.column(), 4
        _title(column, "Mine")
        column.menu("LAMINA_MT_user_presets", icon="USER")
        column.operator("lamina.preset_save", text="Save as Preset...", icon="FILE_TICK")
        try:
            categories = presets.by_category()
        except (native.NativeMissingError, ValueError) as error:
            column.label(text=messages.sentence(error), icon="ERROR")
            return
        for category, entries in categories.items():
            rows = len(entries) + 2
            if height + rows > TALLEST:
                column, height = columns.column(), 0
            if height:
                column.separator()
            height += rows
            _title(column, category[:1].upper() + category[1:])
            for entry in entries:
                name, row = entry.name or entry.id, column.row()
                row.enabled = not presets.problem(material, entry, over == "OVER")
                choice = row.operator("lamina.preset_apply", text=name)
                choice.preset, choice.over = entry.id, over


class LAMINA_MT_user_presets(bpy.types.Menu):
    bl_label = "My Presets"

    def draw(self, _context):
        layout, names = self.layout, presets.user_names()
        if not names:
            layout.label(text="None yet: save one with Save as Preset")
            return
        for name in names:
            choice = layout.operator("lamina.preset_apply", text=name, translate=False)
            choice.preset, choice.user = name, True
        layout.separator()
        layout.menu("LAMINA_MT_user_presets_delete", icon="TRASH")


class LAMINA_MT_user_presets_delete(bpy.types.Menu):
    bl_label = "Delete"

    def draw(self, _context):
        # In a menu operators run at once, but deleting needs a confirmation.
        self.layout.operator_context = "INVOKE_DEFAULT"
        for name in presets.user_names():
            self.layout.operator("lamina.preset_delete", text=name, translate=False).name = name


class LAMINA_MT_metals(bpy.types.Menu):
    bl_label = "Metals"
    bl_description = "Metals by name, with the colors of their published spectra"

    def draw(self, _context):
        try:
            names = metals.names()
        except native.NativeMissingError as error:
            self.layout.label(text=str(error), icon="ERROR")
            return
        for name in names:
            self.layout.operator("lamina.metal", text=metals.label(name)).metal = name


def _title(column, text):
    column.label(text=text)
    column.separator()


def _draw_object_menu(self, _context):
    """Entries of the 3D view's menu Object."""
    self.layout.separator()
    self.layout.operator_menu_enum("lamina.dust_objects", "which", icon="FORCE_FORCE")
    self.layout.operator_menu_enum("lamina.dust_objects_remove", "which")


CLASSES = (
    LAMINA_MT_stack,
    LAMINA_MT_presets,
    LAMINA_MT_user_presets,
    LAMINA_MT_user_presets_delete,
    LAMINA_MT_metals,
)

_register_classes, _unregister_classes = bpy.utils.register_classes_factory(CLASSES)


def register():
    _register_classes()
    bpy.types.VIEW3D_MT_object.append(_draw_object_menu)


def unregister():
    bpy.types.VIEW3D_MT_object.remove(_draw_object_menu)
    _unregister_classes()
