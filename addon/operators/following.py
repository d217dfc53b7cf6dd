# SPDX-License-Identifier: GPL-3.0-or-later
"""Base of operators with a worker: blocking in the background, otherwise modal, with a timer that checks the
worker, ESC to cancel, and a status line."""

import bpy

from ..base import native, redraw, renders

INTERVAL = 0.1  # seconds between two checks of the worker

_signs = []  # the visible ones


class _Sign:
    """The timer and the status line of one operator. They outlive an operator whose add-on is disabled."""

    def __init__(self, context, text):
        self._manager = context.window_manager
        self._timer = self._manager.event_timer_add(INTERVAL, window=context.window)
        self._workspace = context.workspace
        self._tell(text)
        _signs.append(self)

    def remove(self):
        if self in _signs:
            _signs.remove(self)
            self._manager.event_timer_remove(self._timer)
            self._tell(None)

    def _tell(self, text):
        if self._workspace is not None:
            self._workspace.status_text_set(text)


class Following:
    """Mixin for an operator with `jobs`, a module with forget() and stop(), and

    * execute(context), which blocks;
    * start(context), which returns (job, text of the status line);
    * told(done), the message on what job.finish() has returned;
    * failed(error, context, job), which reports an error; `job` is None before the start;
    * `kept`, the message after a cancel.

    The job begins after the render of a preview where it must, see `changes_engine`."""

    kept = "Cancelled"
    changes_engine = False  # `start` writes render.engine, see renders.end_previews

    def invoke(self, context, _event):
        if bpy.app.background:
            return self.execute(context)
        if self.changes_engine and renders.is_bound_to_preview():
            return self.follow(context, None, "Lamina waits for the render of a preview")
        try:
            job, text = self.start(context)
        except Exception as error:
            return self.failed(error, context)
        return self.follow(context, job, text)

    def ended(self, context, job):
        try:
            done = job.finish()
        except native.require().Cancelled:
            done = None
        except Exception as error:
            return self.failed(error, context, job)
        if not done:
            self.report({"INFO"}, self.kept)
            return {"CANCELLED"}
        self.report({"INFO"}, self.told(done))
        return {"FINISHED"}

    def follow(self, context, job, text):
        self._show(context, job, text)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def _show(self, context, job, text):
        self._job = job
        self._sign = _Sign(context, f"{text} | ESC: Cancel")

    def modal(self, context, event):
        if self._job is None:
            return self._wait(context, event)
        if event.type == "ESC" and event.value == "PRESS" and not self._job.cancelling:
            self._job.cancel()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        redraw.properties()
        if not self._job.done:
            self._job.tick()
            return {"PASS_THROUGH"}
        if renders.is_running():
            self._job.text = "Waiting for the render"
            return {"PASS_THROUGH"}
        self._end()
        return self.ended(context, self._job)

    def _wait(self, context, event):
        """Wait for the end of a preview's render, then start the job."""
        is_ended = event.type == "ESC" and event.value == "PRESS"
        if not is_ended and (event.type != "TIMER" or renders.is_bound_to_preview()):
            return {"PASS_THROUGH"}
        self._sign.remove()
        if is_ended or not self.poll(context):
            return {"CANCELLED"}
        try:
            self._show(context, *self.start(context))
        except Exception as error:
            return self.failed(error, context)
        return {"RUNNING_MODAL"}

    def cancel(self, _context):
        """Called when Blender ends the operator: another file, or the end of the session."""
        self.jobs.stop()
        self._end()

    def _end(self):
        self.jobs.forget()
        self._sign.remove()
        redraw.properties()


def stop():
    """Remove the timers and status lines of all running operators: when the add-on is disabled, Blender drops
    its operators without a call to `cancel`."""
    for sign in list(_signs):
        sign.remove()
