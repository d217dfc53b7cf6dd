# SPDX-License-Identifier: GPL-3.0-or-later
"""Connect the baked node group to the material output."""

import bpy

from ..nodes import node_group
from . import common


class LAMINA_OT_connect(bpy.types.Operator):
    bl_idname = "lamina.connect"
    bl_label = "Connect to Output"
    bl_description = "Link the baked node group to the Surface of the material output; other nodes stay"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not common.has_stack(cls, context):
            return False
        if common.material_of(context).lamina.node_group is None:
            cls.poll_message_set("Bake first")
            return False
        return True

    def execute(self, context):
        node_group.connect(common.material_of(context))
        return {"FINISHED"}
