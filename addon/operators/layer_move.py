# SPDX-License-Identifier: GPL-3.0-or-later
"""Move a layer up or down."""

import bpy

from ..editing import layer_list
from . import common


class LAMINA_OT_layer_move(bpy.types.Operator):
    bl_idname = "lamina.layer_move"
    bl_label = "Move Layer"
    bl_description = "Move the selected layer towards the light or towards the base"
    bl_options = {"REGISTER", "UNDO"}

    direction: bpy.props.EnumProperty(
        description="Towards the light, or towards the base",
        name="Direction",
        items=(("UP", "Up", "Towards the light"), ("DOWN", "Down", "Towards the base")),
        default="UP",
    )

    @classmethod
    def poll(cls, context):
        return common.has_layer(cls, context)

    def execute(self, context):
        moved = layer_list.move_layer(common.material_of(context), self.direction)
        return {"FINISHED"} if moved else {"CANCELLED"}
