# SPDX-License-Identifier: GPL-3.0-or-later
"""Cancel the settling of dust."""

import bpy

from ..settling import dust_job
from .cancelling import Cancelling


class LAMINA_OT_dust_cancel(Cancelling, bpy.types.Operator):
    bl_idname = "lamina.dust_cancel"
    bl_label = "Cancel Dust"
    bl_description = "Stop settling; the earlier dust is kept"
    bl_options = {"INTERNAL"}

    jobs = dust_job
