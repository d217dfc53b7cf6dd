# SPDX-License-Identifier: GPL-3.0-or-later
"""Replace an imported depth profile."""

import bpy

from ..editing import layer_list
from ..stack_json import profiles
from . import common


class LAMINA_OT_profile_replace(bpy.types.Operator):
    bl_idname = "lamina.profile_replace"
    bl_label = "Replace Profile"
    bl_description = "Discard the imported depth profile; its top and bottom stay as numbers"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return common.has_layer(cls, context)

    def execute(self, context):
        profiles.replace(layer_list.active_layer(common.material_of(context)))
        return {"FINISHED"}
