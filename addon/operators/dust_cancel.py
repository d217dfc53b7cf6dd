# SPDX-License-Identifier: GPL-3.0-or-later
"""Cancel the settling of dust."""

import bpy

from ..settling import dust_job


class LAMINA_OT_dust_cancel(bpy.types.Operator):
    bl_idname = "lamina.dust_cancel"
    bl_label = "Cancel Dust"
    bl_description = "Stop settling; the earlier dust is kept"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, _context):
        return dust_job.running() is not None

    def execute(self, _context):
        dust_job.running().cancel()
        return {"FINISHED"}
