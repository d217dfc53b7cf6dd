# SPDX-License-Identifier: GPL-3.0-or-later
"""Strokes on the packed images of thickness, coverage and masks are saved with the file.

Blender saves a packed image as it was packed last, without what was painted since then. Blender offers to
save the strokes only when it quits."""

import bpy
from bpy.app.handlers import persistent

from ..base import handlers
from . import thickness


def of(material):
    """The painted images that a material reads, and those that it keeps for later."""
    read = thickness.images_read(material.node_tree) if material.node_tree is not None else set()
    kept = map(material.get, thickness.kept_keys(material))
    return read.union(image for image in kept if image is not None)


@persistent
def pack(*_):
    """Pack all such images that were painted since they were packed."""
    for material in bpy.data.materials:
        if not material.lamina.enabled:
            continue
        for image in of(material):
            if image.is_dirty and image.packed_file is not None and image.is_editable:
                image.pack()


HANDLERS = {"save_pre": pack}


def register():
    handlers.add(HANDLERS)


def unregister():
    handlers.remove(HANDLERS)
