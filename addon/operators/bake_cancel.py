# SPDX-License-Identifier: GPL-3.0-or-later
"""Cancel the running bake."""

import bpy

from ..baking import bake_job


class LAMINA_OT_bake_cancel(bpy.types.Operator):
    bl_idname = "lamina.bake_cancel"
    bl_label = "Cancel Bake"
    bl_description = "Stop the running bake; the earlier one is kept"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, _context):
        return bake_job.running() is not None

    def execute(self, _context):
        bake_job.running().cancel()
        return {"FINISHED"}
