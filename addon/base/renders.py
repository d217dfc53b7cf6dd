# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's renders in threads of their own. Blender crashes if such a render reads a node tree or an image
while the main thread changes or removes it (seen in 4.3 and 5.2)."""

import bpy

from . import data_image


def is_running():
    """True during a render of the scene. Changes to nodes and images must wait until it ends."""
    return any(bpy.app.is_job_running(job) for job in ("RENDER", "OBJECT_BAKE"))


def stop_previews():
    """Stop all renders of previews, such as the ball beside a material's name. Call this before nodes or
    images of materials change. After the change Blender renders the previews again.

    Blender's own operators on nodes stop these renders as well; Python has no function for this. The
    operator that unpacks an image stops them first, here for an image that exists for this purpose alone.
    Nothing is stopped before Blender 5.2: in 4.3, Python may not write to data-blocks afterwards (tried)."""
    if bpy.app.version < (5, 2, 0) or bpy.app.background or not bpy.app.is_job_running("RENDER_PREVIEW"):
        return
    image = data_image.black("Lamina previews", 1)
    with bpy.context.temp_override(edit_image=image):
        bpy.ops.image.unpack(method="REMOVE", id=image.name)
    bpy.data.images.remove(image)
