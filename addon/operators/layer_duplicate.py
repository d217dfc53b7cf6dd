# SPDX-License-Identifier: GPL-3.0-or-later
"""Duplicate a layer."""

import bpy

from ..editing import layer_list
from . import common


class LAMINA_OT_layer_duplicate(bpy.types.Operator):
    bl_idname = "lamina.layer_duplicate"
    bl_label = "Duplicate Layer"
    bl_description = "Put a copy of the selected layer below it"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return common.has_layer(cls, context)

    def execute(self, context):
        layer_list.duplicate_layer(common.material_of(context))
        return {"FINISHED"}
