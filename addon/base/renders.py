# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's renders in threads of their own. Blender crashes if such a render reads a node tree or an image
while the main thread changes or removes it (seen in 4.3 and 5.2)."""

import time
from contextlib import contextmanager

import bpy

from .messages import RefusedError

# From this version on, stop_previews() ends renders of previews.
STOPS_PREVIEWS = (5, 2, 0)
# Seconds: in COPY a render of a preview copies its scene. For AGAIN after a wait no other render starts,
# because the main thread is busy with one operator.
COPY, AGAIN = 0.1, 0.05


class LAMINA_OT_stop_previews(bpy.types.Macro):
    """Calls the operator that reloads an image, which first stops the renders of previews. Blender writes the
    operators that a macro calls neither to the console nor to the Info log."""

    bl_idname = "lamina.stop_previews"
    bl_label = "Stop Renders of Previews"
    bl_description = "For the add-on: nodes and images may change afterwards"
    bl_options = {"INTERNAL"}


_waited = 0.0  # when _wait_for_the_copy last ended; time.monotonic()
_held, _own = [], []  # one entry for each block that is being executed


def is_running():
    """True during a render that would crash at changes to nodes and images: changes must wait until it ends.
    Such are renders of the scene, and before STOPS_PREVIEWS those of previews, which take some tenths of a
    second."""
    return is_bound_to_preview() or is_scene_rendering()


def is_bound_to_preview():
    """True before STOPS_PREVIEWS during a render of a preview, for whose end one can only wait."""
    return bpy.app.version < STOPS_PREVIEWS and bpy.app.is_job_running("RENDER_PREVIEW")


def is_scene_rendering():
    """True while a window renders or bakes the scene: that render reads the scene's settings. False while the
    render is held."""
    return not _held and any(bpy.app.is_job_running(job) for job in ("RENDER", "OBJECT_BAKE"))


def stop_previews():
    """Stop all renders of previews, such as the ball beside a material's name. Call this before nodes, images
    or layers of materials change. After the change Blender renders the previews again.

    Blender's own operators on nodes and images stop these renders as well; Python has no function for this.
    Nothing is stopped before Blender 5.2: in 4.3, Python may not write to data-blocks afterwards (tried).
    There, finished bakes wait until the end of the render, see is_running(), and operators only until the
    render has copied its scene."""
    if bpy.app.background or not bpy.app.is_job_running("RENDER_PREVIEW"):
        return
    if bpy.app.version < STOPS_PREVIEWS:
        _wait_for_the_copy()
        return
    image = bpy.data.images.new("Lamina previews", 1, 1)
    with bpy.context.temp_override(edit_image=image):
        bpy.ops.lamina.stop_previews()
    bpy.data.images.remove(image)


def end_previews():
    """Call this on the main thread before `render.engine` of any scene is written. Blender then waits for the
    thread of a preview's render, which in Cycles waits for the lock that this thread holds: for ever (seen in
    4.3 and 5.2). The next preview starts when Python gives Blender control again.

    Raises RefusedError if a preview's render cannot be stopped."""
    if not bpy.app.background and is_bound_to_preview():
        raise RefusedError("Blender renders a preview: try again when it is finished")
    stop_previews()


@contextmanager
def held():
    """A render waits at its start, before it reads anything, until the block ends: the main thread may change
    nodes and images."""
    with _noted(_held):
        yield


def is_held():
    return bool(_held)


def is_own():
    """True while Lamina renders for itself, see own_render."""
    return bool(_own)


@contextmanager
def _noted(entries):
    entries.append(None)
    try:
        yield
    finally:
        entries.pop()


@contextmanager
def own_render():
    """A render that Lamina makes for itself, in the Image Editor's last slot: the artist's picture stays."""
    image = bpy.data.images.get("Render Result")
    slots = image.render_slots if image is not None and image.type == "RENDER_RESULT" else ()
    active = slots.active_index if len(slots) > 1 else None
    try:
        if active is not None:
            slots.active_index = len(slots) - 1
        with _noted(_own):
            yield
    finally:
        if active is not None:
            slots.active_index = active


def _wait_for_the_copy():
    global _waited
    if time.monotonic() - _waited > AGAIN:
        time.sleep(COPY)
    _waited = time.monotonic()


def register():
    bpy.utils.register_class(LAMINA_OT_stop_previews)
    LAMINA_OT_stop_previews.define("IMAGE_OT_reload")


def unregister():
    bpy.utils.unregister_class(LAMINA_OT_stop_previews)
