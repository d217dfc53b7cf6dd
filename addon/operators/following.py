# SPDX-License-Identifier: GPL-3.0-or-later
"""What modal operators around a worker share: a timer that looks at it, ESC that cancels, a status line."""

from .. import redraw

INTERVAL = 0.1  # seconds between two looks at the worker


class Following:
    """Mixed into an operator that has `jobs` (a module with forget() and stop()) and ended(context, job)."""

    def follow(self, context, job, text):
        self._job = job
        self._timer = context.window_manager.event_timer_add(INTERVAL, window=context.window)
        self._workspace = context.workspace
        context.window_manager.modal_handler_add(self)
        self._tell(f"{text} | ESC: Cancel")
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS" and not self._job.cancelling:
            self._job.cancel()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        redraw.properties()
        if not self._job.done:
            return {"PASS_THROUGH"}
        self._end(context)
        return self.ended(context, self._job)

    def cancel(self, context):
        """Blender ends the operator: another file, or the end of the session."""
        self.jobs.stop()
        self._end(context)

    def _end(self, context):
        self.jobs.forget()
        context.window_manager.event_timer_remove(self._timer)
        self._tell(None)
        redraw.properties()

    def _tell(self, text):
        if self._workspace is not None:
            self._workspace.status_text_set(text)
