# SPDX-License-Identifier: GPL-3.0-or-later
"""Removal of images that a render may still read.

Previews of materials and viewports render in threads of their own, which hold pointers to the images of the
main thread. Blender crashes if an image is removed before such a thread has read its pixels (seen in 4.3). A
preview holds such pointers before its render starts: Blender copies the nodes at once, but starts the render
of an icon two seconds later, and tells of no running job meanwhile. In a window, an unused image therefore
stays until all such renders have started and none runs. Blender does not save images without users."""

import bpy
from bpy.app.handlers import persistent

from . import handlers, renders, timers
from .worker import with_uid

INTERVAL = 0.25  # seconds between two looks
# An image is removed after this many looks, some ten seconds. Between any two of them Blender also starts the
# previews that are due, and draws viewports, which are not among the jobs.
LOOKS = 40
UNUSED = " (unused)"  # after the name of an image that will be removed
LONGEST = 63  # bytes of a name, in Blender before 5.0

_unused = []  # of images that wait: an _Unused each


class _Unused:
    def __init__(self, image):
        self.uid, self.users, self.looks = image.session_uid, image.users, 0
        self.name = image.name.removesuffix(UNUSED)
        self.stays = False  # undo has given the image to a node again


def remove(image):
    """Remove an image, at once or later. Users that the image still has lose it."""
    if bpy.app.background:
        bpy.data.images.remove(image)
        return
    entry = _Unused(image)
    _unused.append(entry)
    short = entry.name.encode()[: LONGEST - len(UNUSED)].decode(errors="ignore")
    image.name = short + UNUSED  # leaves the name to another image
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
    """The timer's function: remove what no render can read any more, and name what stays."""
    is_running = renders.is_running() or bpy.app.is_job_running("RENDER_PREVIEW")
    for entry in _unused[:]:
        entry.looks += 1
        is_due = entry.looks > LOOKS and not is_running
        if not (entry.stays or is_due):
            continue
        image = with_uid(bpy.data.images, entry.uid)
        if image is not None and entry.stays:
            image.name = entry.name
        elif image is not None and image.users <= entry.users:
            bpy.data.images.remove(image)
        _unused.remove(entry)
    return INTERVAL if _unused else None


@persistent
def _on_load(*_):
    _unused.clear()


@persistent
def _on_undo(*_):
    # Blender 4.3 does not always allow a name to be written here: the timer writes it.
    for entry in _unused:
        image = with_uid(bpy.data.images, entry.uid)
        entry.stays = image is not None and image.users > 0


HANDLERS = {"load_pre": _on_load, "undo_post": _on_undo, "redo_post": _on_undo}


def register():
    handlers.add(HANDLERS)


def unregister():
    timers.end(poll)
    handlers.remove(HANDLERS)
    _unused.clear()
