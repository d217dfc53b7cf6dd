# SPDX-License-Identifier: GPL-3.0-or-later
"""Strokes on the packed images of thickness and coverage are saved with the file.

Blender saves a packed image as it was packed last, and offers to save what was painted since only when it
quits."""

import bpy
from bpy.app.handlers import persistent

from ..base import handlers
from . import thickness


def of(material):
    """The images that a material reads as thickness or coverage, and those that it keeps for later."""
    tree = material.node_tree
    nodes = tree.nodes if tree is not None else ()
    read = [node.image for node in nodes if node.get(thickness.MARK, "").endswith("image")]
    return {image for image in (*read, *map(material.get, thickness.KEPT.values())) if image is not None}


@persistent
def pack(*_):
    """Pack all such images that were painted since they were packed."""
    for material in bpy.data.materials:
        for image in of(material) if material.lamina.enabled else ():
            if image.is_dirty and image.packed_file is not None and image.is_editable:
                image.pack()


HANDLERS = {"save_pre": pack}


def register():
    handlers.add(HANDLERS)


def unregister():
    handlers.remove(HANDLERS)
