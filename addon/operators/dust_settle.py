# SPDX-License-Identifier: GPL-3.0-or-later
"""Let dust settle: blocking in the background, otherwise modal around a worker thread."""

import bpy

from ..base import messages, native, preferences
from ..settling import dust_job, object_dust
from . import common
from .following import Following


class LAMINA_OT_dust_settle(Following, bpy.types.Operator):
    bl_idname = "lamina.dust_settle"
    bl_label = "Settle Dust"
    bl_description = (
        "Let dust settle on this object and, with All Selected, on each one that is selected. ESC cancels"
    )
    bl_options = {"REGISTER", "UNDO"}

    jobs = dust_job

    selected: bpy.props.BoolProperty(
        name="All Selected", description="Every selected mesh, each with its own settings"
    )

    @classmethod
    def poll(cls, context):
        return common.can_be_dusty(cls, context)

    def execute(self, context):
        """Settle and wait for it: scripts, and everything under `blender -b`."""
        try:
            for obj in self._objects(context):
                object_dust.settle(context, obj, threads=preferences.threads())
        except Exception as error:
            return self._failed(error)
        return {"FINISHED"}

    def invoke(self, context, _event):
        if bpy.app.background:
            return self.execute(context)
        try:
            objects = self._objects(context)
            job = dust_job.start(context, objects)
        except Exception as error:
            return self._failed(error)
        names = objects[0].name if len(objects) == 1 else f"{len(objects)} objects"
        return self.follow(context, job, f"Dust settles on {names}")

    def ended(self, _context, job):
        try:
            done = job.finish()
        except native.require().Cancelled:
            done = []
        except Exception as error:
            return self._failed(error)
        if not done:
            self.report({"INFO"}, "Cancelled; the last dust is kept")
            return {"CANCELLED"}
        self.report({"INFO"}, "; ".join(f"{obj.name}: {obj.lamina_dust.told}" for obj in done))
        return {"FINISHED"}

    def _objects(self, context):
        if not self.selected:
            return [context.object]
        chosen = [obj for obj in context.selected_objects if obj.type == "MESH"]
        return chosen or [context.object]

    def _failed(self, error):
        if not messages.expected(error):
            dust_job.log.error("dust failed", exc_info=error)
        self.report({"ERROR"}, messages.sentence(error))
        return {"CANCELLED"}
