# SPDX-License-Identifier: GPL-3.0-or-later
"""Remove a layer."""

import bpy

from ..editing import layer_list
from . import common


class LAMINA_OT_layer_remove(bpy.types.Operator):
    bl_idname = "lamina.layer_remove"
    bl_label = "Remove Layer"
    bl_description = "Remove the selected layer"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return common.has_layer(cls, context)

    def execute(self, context):
        layer_list.remove_layer(common.material_of(context))
        return {"FINISHED"}
