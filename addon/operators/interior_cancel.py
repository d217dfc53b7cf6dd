# SPDX-License-Identifier: GPL-3.0-or-later
"""Cancel the running computation of an interior."""

import bpy

from ..interior import interior_job
from .cancelling import Cancelling


class LAMINA_OT_interior_cancel(Cancelling, bpy.types.Operator):
    bl_idname = "lamina.interior_cancel"
    bl_label = "Cancel"
    bl_description = (
        "Stop the computation. The images so far stay, if any are shown yet; Undo restores the earlier "
        "nodes. Finished parts are kept, and the next start continues after them"
    )
    bl_options = {"INTERNAL"}

    jobs = interior_job
