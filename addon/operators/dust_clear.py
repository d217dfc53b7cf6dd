# SPDX-License-Identifier: GPL-3.0-or-later
"""Remove the dust of an object."""

import bpy

from ..settling import live_dust, object_dust
from . import common


class LAMINA_OT_dust_clear(bpy.types.Operator):
    bl_idname = "lamina.dust_clear"
    bl_label = "Clear Dust"
    bl_description = "Remove the settled dust from this object"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return common.has_dust(cls, context)

    def execute(self, context):
        live_dust.leave(context.object)
        object_dust.clear(context.object)
        return {"FINISHED"}
