# SPDX-License-Identifier: GPL-3.0-or-later
"""Removal of images that a render may still read.

Previews of materials and viewports render in threads of their own, which hold pointers to the images of the
main thread. Blender crashes if an image is removed before such a thread has read its pixels (seen in 4.3). In
a window, an unused image therefore stays until no render runs, or until every render that knew the image must
have started anew. Blender does not save images without users."""

import time

import bpy
from bpy.app.handlers import persistent

from . import handlers, renders, timers
from .worker import with_uid

INTERVAL = 1.0  # seconds between two looks
UNUSED = " (unused)"  # after the name of an image that will be removed
LEAST = 1.0  # seconds that an image stays: a viewport is not among the jobs, and starts anew by then
LONGEST = 30.0  # seconds that an image stays while jobs follow one another, as previews do during Live

_unused = []  # (session_uid, number of users, time) of images


def remove(image):
    """Remove an image, at once or later. Users that the image still has lose it."""
    if bpy.app.background:
        bpy.data.images.remove(image)
        return
    _unused.append((image.session_uid, image.users, time.monotonic()))
    image.name += UNUSED  # leaves the name to another image
    timers.start(poll, INTERVAL)


def remove_unused(images):
    """Remove those of the images that have no users."""
    for image in images:
        if image.users == 0:
            remove(image)


def replace(old, new):
    """Put the image `new` in the place of `old` everywhere, under the name of `old`, and remove `old`."""
    name = old.name
    old.user_remap(new)
    remove(old)
    new.name = name


def poll():
    """The timer's function: remove what no render can read any more."""
    now, is_running = time.monotonic(), renders.is_running() or bpy.app.is_job_running("RENDER_PREVIEW")
    for entry in _unused[:]:
        uid, users, since = entry
        if now - since > (LONGEST if is_running else LEAST):
            image = with_uid(bpy.data.images, uid)
            if image is not None and image.users <= users:
                bpy.data.images.remove(image)
            _unused.remove(entry)
    return INTERVAL if _unused else None


@persistent
def _on_load(*_):
    _unused.clear()


@persistent
def _on_undo(*_):
    # An image that undo has given to a node again stays, under its old name.
    for entry in _unused[:]:
        image = with_uid(bpy.data.images, entry[0])
        if image is not None and image.users:
            _unused.remove(entry)
            image.name = image.name.removesuffix(UNUSED)


HANDLERS = {"load_pre": _on_load, "undo_post": _on_undo, "redo_post": _on_undo}


def register():
    handlers.add(HANDLERS)


def unregister():
    timers.end(poll)
    handlers.remove(HANDLERS)
    _unused.clear()
