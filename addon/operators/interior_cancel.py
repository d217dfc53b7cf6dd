# SPDX-License-Identifier: GPL-3.0-or-later
"""Cancel the running computation of an interior."""

import bpy

from ..interior import interior_job
from .cancelling import Cancelling


class LAMINA_OT_interior_cancel(Cancelling, bpy.types.Operator):
    bl_idname = "lamina.interior_cancel"
    bl_label = "Cancel"
    bl_description = "Stop the computation; the earlier nodes and the finished parts are kept"
    bl_options = {"INTERNAL"}

    jobs = interior_job
