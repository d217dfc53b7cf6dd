# SPDX-License-Identifier: GPL-3.0-or-later
"""A render of the scene waits at its start until all updates are applied.

At F12 Blender calls render_init in the thread of the render. This thread may not write, because Blender may
crash when the main thread draws meanwhile (seen in 4.3). So it waits. The main thread goes on, and the timer
of the updates applies them there. When a script renders, Blender calls render_init in the main thread, which
then makes the updates itself."""

import sys
import threading
import time

import bpy
from bpy.app.handlers import persistent

from ..base import handlers, renders
from . import update

STEP = 0.02  # seconds between two looks
# Seconds after which the render starts without the updates: since its start, and since the last call of the
# updates' timer. The main thread calls no timer while it waits for the end of the render, for example because
# another file is opened.
LONGEST, DEAF = 120.0, 3.0


def wait():
    """Wait in the render's thread until the main thread has applied all updates."""
    begun = time.monotonic()
    with renders.held():
        while update.are_pending():
            time.sleep(STEP)
            now = time.monotonic()
            is_late = now - begun > LONGEST or now - max(begun, update.looked()) > DEAF
            # Without a frame of Python, the main thread does not write now.
            if is_late and threading.main_thread().ident not in sys._current_frames():
                return


@persistent
def _before_render(*_):
    if bpy.app.background or renders.is_own() or not update.are_pending():
        return
    if threading.current_thread() is threading.main_thread():
        with renders.held():
            update.finish()
    else:
        wait()


HANDLERS = {"render_init": _before_render}


def register():
    handlers.add(HANDLERS)


def unregister():
    handlers.remove(HANDLERS)
