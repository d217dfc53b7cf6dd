# SPDX-License-Identifier: GPL-3.0-or-later
"""A render of the scene shows finished updates: it waits at its start until they are applied.

At F12 Blender calls render_init in the thread of the render, which may not write: Blender crashes if the
main thread draws meanwhile (seen in 4.3). So that thread waits, and the timer of the updates writes, on the
main thread, which goes on. At a render by a script, the main thread itself calls render_init, and works."""

import sys
import threading
import time

import bpy
from bpy.app.handlers import persistent

from ..base import handlers, renders
from . import update

STEP = 0.02  # seconds between two looks
# The render starts without the updates after this many seconds, or if the main thread is deaf: it may wait
# for the end of the render, because another file is opened.
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
