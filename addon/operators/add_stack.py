# SPDX-License-Identifier: GPL-3.0-or-later
"""Add Lamina Layers."""

import bpy

from ..editing import layer_list
from . import common


class LAMINA_OT_add_stack(bpy.types.Operator):
    bl_idname = "lamina.add_stack"
    bl_label = "Add Lamina Layers"
    bl_description = "Give this material a stack of layers. The render stays as it is until the first bake"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return common.can_edit(cls, context)

    def execute(self, context):
        layer_list.add_stack(common.material_of(context))
        return {"FINISHED"}
