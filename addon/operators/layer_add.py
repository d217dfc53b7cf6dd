# SPDX-License-Identifier: GPL-3.0-or-later
"""Add a layer."""

import bpy

from ..editing import layer_list
from ..properties.layer_properties import LAYER_KINDS
from . import common


class LAMINA_OT_layer_add(bpy.types.Operator):
    bl_idname = "lamina.layer_add"
    bl_label = "Add Layer"
    bl_description = "Add a layer above the selected one"
    bl_options = {"REGISTER", "UNDO"}

    kind: bpy.props.EnumProperty(
        name="Kind", description="What the new layer is", items=LAYER_KINDS, default="medium"
    )

    @classmethod
    def poll(cls, context):
        return common.has_stack(cls, context)

    def execute(self, context):
        layer_list.add_layer(common.material_of(context), self.kind)
        return {"FINISHED"}
