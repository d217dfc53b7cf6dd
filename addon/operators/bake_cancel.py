# SPDX-License-Identifier: GPL-3.0-or-later
"""Cancel the running bake."""

import bpy

from ..baking import bake_job
from .cancelling import Cancelling


class LAMINA_OT_bake_cancel(Cancelling, bpy.types.Operator):
    bl_idname = "lamina.bake_cancel"
    bl_label = "Cancel Bake"
    bl_description = "Stop the running bake; the earlier one is kept"
    bl_options = {"INTERNAL"}

    jobs = bake_job
