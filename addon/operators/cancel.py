# SPDX-License-Identifier: GPL-3.0-or-later
"""Cancel work that runs beside Blender."""

import bpy

from ..baking import bake_job, lateral_job, update
from ..editing import match_job
from ..interior import interior_job, trial
from ..settling import dust_job

JOBS = {
    "BAKE": bake_job,
    "UPDATE": update,
    "LATERAL": lateral_job,
    "MATCH": match_job,
    "INTERIOR": interior_job,
    "TRIAL": trial,
    "DUST": dust_job,
}
WORK = (
    ("BAKE", "Bake", "Stop the running bake; the earlier one is kept"),
    ("UPDATE", "Update", "Stop the running bake; the material stays as it is shown now"),
    ("LATERAL", "Lateral", "Stop the computation; the earlier nodes are kept"),
    ("MATCH", "Match", "Stop the search; the earlier layers are kept"),
    (
        "INTERIOR",
        "Interior",
        "Stop the computation. The images so far stay, if any are shown yet; Undo restores the earlier "
        "nodes. Finished parts are kept, and the next start continues after them",
    ),
    ("TRIAL", "Trial", "Stop the trial; the nodes stay as they are"),
    ("DUST", "Dust", "Stop settling; the earlier dust is kept"),
)


class LAMINA_OT_cancel(bpy.types.Operator):
    bl_idname = "lamina.cancel"
    bl_label = "Cancel"
    bl_description = "Stop work that is running"
    bl_options = {"INTERNAL"}

    work: bpy.props.EnumProperty(name="Work", description="What to stop", items=WORK, options={"SKIP_SAVE"})

    @classmethod
    def description(cls, _context, properties):
        return next(text for work, _name, text in WORK if work == properties.work)

    def execute(self, _context):
        job = JOBS[self.work].running()
        if job is None:
            return {"CANCELLED"}
        job.cancel()
        return {"FINISHED"}
