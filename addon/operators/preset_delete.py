# SPDX-License-Identifier: GPL-3.0-or-later
"""Delete a preset of the user."""

import bpy

from ..editing import presets
from . import common


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
