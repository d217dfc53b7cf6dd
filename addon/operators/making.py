# SPDX-License-Identifier: GPL-3.0-or-later
"""Base of operators that compute nodes of a material."""

from ..base import messages
from . import common
from .following import Following


class Making(Following):
    """Mixin for an operator with `jobs` as in Following, and with

    * jobs.log;
    * made(context, material), which blocks;
    * started(context, material), which returns a worker.OfMaterial;
    * told(material), the report;
    * `status`, the text of the status line before the material's name."""

    kept = "Cancelled; the earlier nodes are kept"

    def execute(self, context):
        """Compute and wait for the result: for scripts and for `blender -b`."""
        material = common.material_of(context)
        try:
            self.made(context, material)
        except Exception as error:
            return self.failed(error, context)
        self.report({"INFO"}, self.told(material))
        return {"FINISHED"}

    def start(self, context):
        material = common.material_of(context)
        return self.started(context, material), f"{self.status} {material.name}"

    def failed(self, error, context, job=None):
        material = common.material_of(context) if job is None else job.material()
        if not messages.expected(error):
            self.jobs.log.error("%s failed", self.bl_idname, exc_info=error)
        self.report({"ERROR"}, messages.sentence(error, material))
        return {"CANCELLED"}


class MakingOnObject(Making):
    """Making for the active object. `jobs` has also problem(obj, material), running(), and make and
    start(context, obj, material); `busy`: the sentence while a job is running."""

    changes_engine = True

    @classmethod
    def poll(cls, context):
        if not common.can_edit(cls, context):
            return False
        sentence = cls.jobs.problem(context.object, common.material_of(context))
        if not sentence and cls.jobs.running() is not None:
            sentence = cls.busy
        if sentence:
            cls.poll_message_set(sentence)
        return not sentence

    def made(self, context, material):
        self.jobs.make(context, context.object, material)

    def started(self, context, material):
        return self.jobs.start(context, context.object, material)
