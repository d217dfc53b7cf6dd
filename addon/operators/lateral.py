# SPDX-License-Identifier: GPL-3.0-or-later
"""Operator for lateral light transport: blocks under `blender -b`, otherwise modal with a worker thread."""

import bpy

from ..baking import lateral_job
from ..base import messages, native
from . import common
from .following import Following


class LAMINA_OT_lateral(Following, bpy.types.Operator):
    bl_idname = "lamina.lateral"
    bl_label = "Let Light Travel Sideways"
    bl_description = "Build nodes whose light enters at one place and leaves at another. ESC cancels"
    bl_options = {"REGISTER", "UNDO"}

    jobs = lateral_job

    @classmethod
    def poll(cls, context):
        if not common.has_stack(cls, context) or not common.has_native(cls):
            return False
        if lateral_job.running() is not None:
            cls.poll_message_set("Light that travels sideways is being computed")
            return False
        return True

    def execute(self, context):
        """Compute and wait for the result: for scripts and for `blender -b`."""
        material = common.material_of(context)
        try:
            lateral_job.make(material, context.scene)
        except Exception as error:
            return self._failed(error, material)
        return self._told(material)

    def invoke(self, context, _event):
        if bpy.app.background:
            return self.execute(context)
        material = common.material_of(context)
        try:
            job = lateral_job.start(material, context.scene)
        except Exception as error:
            return self._failed(error, material)
        return self.follow(context, job, f"Lamina follows light below {material.name}")

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
        return self._told(material)

    def _told(self, material):
        self.report({"INFO"}, material.lamina.lateral_report)
        return {"FINISHED"}

    def _failed(self, error, material=None):
        if not messages.expected(error):
            lateral_job.log.error("lateral light failed", exc_info=error)
        self.report({"ERROR"}, messages.sentence(error, material))
        return {"CANCELLED"}
