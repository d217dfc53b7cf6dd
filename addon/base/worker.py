# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work in a thread that the main thread polls. The thread never touches Blender data."""

import threading

import bpy
from bpy.app.handlers import persistent

from . import handlers


class Worker:
    """Runs work(progress, cancel) in a thread. `fraction` and `text` hold its progress; at its end `result`
    or `error` is set.
    """

    def __init__(self, work, name):
        self.fraction, self.text = 0.0, "Starting"
        self.result, self.error = None, None
        self._stop = threading.Event()
        self._work = work
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    def cancel(self):
        self._stop.set()

    def tick(self):
        """Called on the main thread from time to time while the work runs."""

    @property
    def cancelling(self):
        return self._stop.is_set()

    @property
    def done(self):
        return not self._thread.is_alive()

    def wait(self, seconds=None):
        self._thread.join(seconds)

    def _run(self):
        try:
            self.result = self._work(self._progress, self._stop.is_set)
        except BaseException as error:  # The main thread reports the error.
            self.error = error

    def _progress(self, fraction, text=""):
        self.fraction, self.text = fraction, text or self.text


def with_uid(blocks, uid):
    """The one of some data-blocks with this session_uid, which stays when a block is renamed; None if the
    block has been deleted."""
    return next((one for one in blocks if one.session_uid == uid), None)


class OfMaterial:
    """Mixin of a Worker for one material, with `uid`, the material's session_uid, and apply(material), which
    uses `result`. The material is found again even if it is renamed meanwhile."""

    def material(self):
        """The material, or None when it has been deleted."""
        return with_uid(bpy.data.materials, self.uid)

    def finish(self):
        """Apply the result to the material; main thread only. Returns the material, or None after a cancel or
        when the material has been deleted.

        Raises the exception of the work. After an exception or a cancel the material is unchanged."""
        if self.error is not None:
            raise self.error
        material = self.material()
        if material is None or self.cancelling:
            return None
        self.apply(material)
        return material


class Place:
    """Holds the one worker that runs. A registered place stops the worker before another file is loaded."""

    def __init__(self):
        self._job = None

        @persistent
        def on_load(*_):
            self.stop()

        self._handlers = {"load_pre": on_load}

    def register(self):
        handlers.add(self._handlers)

    def unregister(self):
        self.stop()
        handlers.remove(self._handlers)

    def take(self, job):
        self._job = job
        return job

    def running(self):
        """The running worker, or None."""
        return self._job

    def running_for(self, block):
        """The running worker with the `uid` of this material or object, or None."""
        return self._job if self._job is not None and self._job.uid == block.session_uid else None

    def forget(self):
        """Drop the worker: its result has been used."""
        self._job = None

    def leave(self, block):
        """Cancel and drop the worker of this material or object; its thread ends by itself."""
        if self.running_for(block) is not None:
            self._job.cancel()
            self.forget()

    def stop(self):
        """Cancel the running worker and wait for its thread."""
        if self._job is not None:
            self._job.cancel()
            self._job.wait()
            self.forget()
