# SPDX-License-Identifier: GPL-3.0-or-later
"""Cancel the running computation of lateral light transport."""

import bpy

from ..baking import lateral_job
from .cancelling import Cancelling


class LAMINA_OT_lateral_cancel(Cancelling, bpy.types.Operator):
    bl_idname = "lamina.lateral_cancel"
    bl_label = "Cancel"
    bl_description = "Stop the computation; the earlier nodes are kept"
    bl_options = {"INTERNAL"}

    jobs = lateral_job
