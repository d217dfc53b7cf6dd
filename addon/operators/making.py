# SPDX-License-Identifier: GPL-3.0-or-later
"""Base of operators that compute nodes of a material: blocking under `blender -b`, otherwise modal with
a worker thread."""

import bpy

from ..base import messages, native
from . import common
from .following import Following


class Making(Following):
    """Mixin for an operator with `jobs`, a module with running(), forget(), stop() and log;
    made(context, material), which blocks; started(context, material), which returns a worker with
    finish(); told(material), the report; and `status`, the text of the status line before the material's
    name."""

    def execute(self, context):
        """Compute and wait for the result: for scripts and for `blender -b`."""
        material = common.material_of(context)
        try:
            self.made(context, material)
        except Exception as error:
            return self._failed(error, material)
        return self._finished(material)

    def invoke(self, context, _event):
        if bpy.app.background:
            return self.execute(context)
        material = common.material_of(context)
        try:
            job = self.started(context, material)
        except Exception as error:
            return self._failed(error, material)
        return self.follow(context, job, f"{self.status} {material.name}")

    def ended(self, _context, job):
        try:
            material = job.finish()
        except native.require().Cancelled:
            material = None
        except Exception as error:
            return self._failed(error)
        if material is None:
            self.report({"INFO"}, "Cancelled; the earlier nodes are kept")
            return {"CANCELLED"}
        return self._finished(material)

    def _finished(self, material):
        self.report({"INFO"}, self.told(material))
        return {"FINISHED"}

    def _failed(self, error, material=None):
        if not messages.expected(error):
            self.jobs.log.error("%s failed", self.bl_idname, exc_info=error)
        self.report({"ERROR"}, messages.sentence(error, material))
        return {"CANCELLED"}
