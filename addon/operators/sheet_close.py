# SPDX-License-Identifier: GPL-3.0-or-later
"""End a thin sheet in air."""

import bpy

from ..editing import layer_list
from . import common


class LAMINA_OT_sheet_close(bpy.types.Operator):
    bl_idname = "lamina.sheet_close"
    bl_label = "Add Back Surface"
    bl_description = "Add an interface of IOR 1 at the bottom, as rough as the one above it: the sheet's back"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return common.has_stack(cls, context)

    def execute(self, context):
        layer_list.close_sheet(common.material_of(context))
        return {"FINISHED"}
