# SPDX-License-Identifier: GPL-3.0-or-later
"""Cancel the running computation of lateral light transport."""

import bpy

from ..baking import lateral_job


class LAMINA_OT_lateral_cancel(bpy.types.Operator):
    bl_idname = "lamina.lateral_cancel"
    bl_label = "Cancel"
    bl_description = "Stop the computation; the earlier nodes are kept"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, _context):
        return lateral_job.running() is not None

    def execute(self, _context):
        lateral_job.running().cancel()
        return {"FINISHED"}
