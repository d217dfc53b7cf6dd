# SPDX-License-Identifier: GPL-3.0-or-later
"""Remove Lamina from a material."""

import bpy

from ..editing import layer_list
from . import common


class LAMINA_OT_remove_stack(bpy.types.Operator):
    bl_idname = "lamina.remove_stack"
    bl_label = "Remove Lamina from Material"
    bl_description = "Remove the layers and restore the material as before; nodes that you have added stay"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return common.has_stack(cls, context) and common.is_idle(cls)

    def execute(self, context):
        layer_list.remove_stack(common.material_of(context))
        return {"FINISHED"}
