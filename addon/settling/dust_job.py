# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust that settles in a worker thread, on one object or several, one after the other."""

import logging

import bpy

from ..base import native, preferences
from ..base.worker import Place, Worker
from . import object_dust

log = logging.getLogger(__name__)

_place = Place()
running, forget, stop, take = _place.running, _place.forget, _place.stop, _place.take
register, unregister = _place.register, _place.unregister


class DustJob(Worker):
    """`answers` holds the answers of finished tasks, in sequence."""

    def __init__(self, tasks, threads):
        self.tasks = tasks
        native.require()

        def work(progress, cancel):
            return [
                object_dust.settle_gathered(task, portion(progress, number, tasks), cancel, threads)
                for number, task in enumerate(tasks)
            ]

        super().__init__(work, "lamina dust")

    def finish(self):
        """Store the dust on all objects; main thread only. Returns the objects, none after a cancel.

        Raises errors of the work; then, and after a cancel, the last dust is unchanged."""
        if self.error is not None:
            raise self.error
        if self.cancelling:
            return []
        by_uid = {obj.session_uid: obj for obj in bpy.data.objects}
        found = [(by_uid[task.uid], task, answer)
                 for task, answer in zip(self.tasks, self.result, strict=True) if task.uid in by_uid]
        for obj, task, _ in found:
            object_dust.check_mesh(obj, task)
        for obj, task, answer in found:
            object_dust.apply(obj, task, answer)
        return [obj for obj, *_ in found]


def portion(progress, number, tasks):
    """The progress of one of several tasks, which tells the object's name."""

    def told(fraction, text=""):
        where = f"{tasks[number].name}: {text}" if len(tasks) > 1 else text
        progress((number + fraction) / len(tasks), where)

    return told


def start(context, objects):
    """Start in the background, one job at a time. Raises as object_dust.gather does, before it starts."""
    return take(DustJob(object_dust.gather_all(context, objects), preferences.threads()))
