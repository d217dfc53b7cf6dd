# SPDX-License-Identifier: GPL-3.0-or-later
"""Save the layers as a preset of the user."""

import bpy

from ..base import messages
from ..editing import presets
from ..kinds.preset_files import LONGEST
from . import common


class LAMINA_OT_preset_save(bpy.types.Operator):
    bl_idname = "lamina.preset_save"
    bl_label = "Save as Preset"
    bl_description = "Keep the layers and base of this material under a name, for all files"
    bl_options = {"REGISTER"}

    name: bpy.props.StringProperty(
        name="Name", description="Name of the new preset", maxlen=LONGEST
    )
    replace: bpy.props.BoolProperty(
        name="Replace", description="Replace a preset of the same name", options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context):
        return common.has_stack(cls, context) and common.has_native(cls)

    def invoke(self, context, _event):
        self.name = common.material_of(context).name[: LONGEST]
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
