# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of the library and of the user."""

import bpy

from ..base import messages, native
from ..editing import presets
from ..kinds.preset_files import LONGEST
from . import common

OVER = (
    ("AUTO", "Automatic", "Overlays, and presets for layers that lie over the material's nodes, lie over it"),
    *presets.OVER,
)
_OVER = {"AUTO": None, "OVER": True, "ALL": False}


class LAMINA_OT_preset_apply(bpy.types.Operator):
    bl_idname = "lamina.preset_apply"
    bl_label = "Apply Preset"
    bl_description = (
        "Replace the layers of this material by those of the preset, and show them. Its base is replaced "
        "too, unless the preset lies over what the material shows"
    )
    bl_options = {"REGISTER", "UNDO"}

    preset: bpy.props.StringProperty(name="Preset", description="Its id, or its name if it is your own")
    user: bpy.props.BoolProperty(
        name="My Preset", description="One of your own, not of the library", options={"SKIP_SAVE"}
    )

    over: bpy.props.EnumProperty(
        name="What", description="What of the preset is used", items=OVER, options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context):
        return common.can_edit(cls, context) and common.has_native(cls) and common.is_idle(cls)

    @classmethod
    def description(cls, context, properties):
        if properties.user or not native.available():
            return cls.bl_description
        try:
            entry = presets.entry(properties.preset)
        except native.NativeMissingError as error:
            return str(error)
        if entry is None:
            return cls.bl_description
        over = _OVER[properties.over]
        first = presets.problem(common.material_of(context), entry, over) or cls.bl_description
        return f"{first}.\n{entry.source.rstrip('.')}"

    def invoke(self, context, _event):
        """A click: apply the preset, bake and show it. Scripts, which execute, bake themselves."""
        if self.execute(context) == {"CANCELLED"}:
            return {"CANCELLED"}
        return common.show_layers(self, context)

    def execute(self, context):
        material = common.material_of(context)
        try:
            if self.user:
                presets.apply_user(material, self.preset)
            else:
                presets.apply(material, self.preset, _OVER[self.over])
        except (ValueError, OSError, native.NativeMissingError) as error:
            return common.refused(self, error)
        return {"FINISHED"}


class LAMINA_OT_preset_save(bpy.types.Operator):
    bl_idname = "lamina.preset_save"
    bl_label = "Save as Preset"
    bl_description = "Keep the layers and base of this material under a name, for all files"
    bl_options = {"REGISTER"}

    name: bpy.props.StringProperty(name="Name", description="Name of the new preset", maxlen=LONGEST)
    replace: bpy.props.BoolProperty(
        name="Replace", description="Replace a preset of the same name", options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context):
        return common.has_stack(cls, context) and common.has_native(cls)

    def invoke(self, context, _event):
        self.name = common.material_of(context).name[:LONGEST]
        return context.window_manager.invoke_props_dialog(self, confirm_text="Save")

    def execute(self, context):
        material = common.material_of(context)
        try:
            name = presets.save_user(material, self.name, self.replace)
        except (ValueError, OSError) as error:
            self.report({"ERROR"}, messages.sentence(error, material))
            return {"CANCELLED"}
        self.report({"INFO"}, f"Saved the preset {name}")
        return {"FINISHED"}


class LAMINA_OT_preset_delete(bpy.types.Operator):
    bl_idname = "lamina.preset_delete"
    bl_label = "Delete Preset"
    bl_description = "Delete this preset of yours. Materials that were made from it stay as they are"
    bl_options = {"REGISTER"}

    name: bpy.props.StringProperty(name="Name", description="Name of the preset")

    def invoke(self, context, event):
        return context.window_manager.invoke_confirm(
            self, event, title=f"Delete the preset “{self.name}”?", message="This cannot be undone.",
            confirm_text="Delete", icon="WARNING",
        )  # fmt: skip

    def execute(self, _context):
        try:
            presets.delete_user(self.name)
        except (ValueError, OSError) as error:
            return common.refused(self, error)
        return {"FINISHED"}
