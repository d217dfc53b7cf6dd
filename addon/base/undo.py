# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps Blender's undo safe while timers change data-blocks.

An undo step holds the file as it was at the end of an operator. When Blender undoes or redoes, a data-block
that is equal in the two steps stays as it is in memory, and one that is in neither step is freed. A timer
that replaces an image makes no step, because Undo would then undo the replacement, which Live would repeat
at once. So a node that stays may use an image that is freed, and Blender crashes.

Therefore all nodes and settings let go of such images before Blender undoes, and take them again afterwards
where they still exist. The others are told to `changes`. A timer that makes another data-block, such as a
node group, or fills one anew, makes a step of its own, see `recorded`: Undo takes the change away."""

from contextlib import contextmanager

import bpy
from bpy.app.handlers import persistent

from . import changes, data_image, handlers, renders, timers
from .worker import with_uid

_held = []  # what let go of its image before the undo: a _Slot each


class _Slot:
    """A place that holds an image: a node of a tree, or the settings of an object. All are found again by the
    owner's session_uid, because undo may replace any data-block."""

    def __init__(self, owners, owner, node, image):
        self.owners, self.uid, self.node, self.image = owners, owner.session_uid, node, image.session_uid

    def place(self):
        """What has the property `image`, or None if it is gone."""
        owner = with_uid(getattr(bpy.data, self.owners), self.uid)
        if owner is None:
            return None
        if self.owners == "objects":
            return owner.lamina_dust
        tree = owner if self.owners == "node_groups" else owner.node_tree
        return tree.nodes.get(self.node) if tree is not None else None


@contextmanager
def recorded(message, always=False):
    """Make an undo step if the block makes a node group or a mesh, or always: for changes that no operator
    records."""
    before = _blocks()
    yield
    if not bpy.app.background and (always or _blocks() - before):
        bpy.ops.ed.undo_push(message=message)


def let_go():
    """Before an undo: take the images that this session has made from all nodes and settings."""
    renders.stop_previews()
    _held[:] = _slots()
    for slot in _held:
        slot.place().image = None


def take_again():
    """After an undo: give the images back, and tell the owners whose image is gone."""
    lost = {}
    for slot in _held:
        place = slot.place()
        if place is None or getattr(place, "image", None) is not None:  # the owner is as in the step
            continue
        place.image = with_uid(bpy.data.images, slot.image)
        if place.image is None:
            lost[slot.owners, slot.uid] = with_uid(getattr(bpy.data, slot.owners), slot.uid)
    _held.clear()
    for owner in lost.values():
        changes.lose_image(owner)


def _slots():
    """All places that hold an image of this session, as _Slot."""
    found = []
    for owners in ("node_groups", "materials"):
        for owner in getattr(bpy.data, owners):
            tree = owner if owners == "node_groups" else owner.node_tree
            for node in tree.nodes if tree is not None else ():
                if _is_ours(getattr(node, "image", None)):
                    found.append(_Slot(owners, owner, node.name, node.image))
    for obj in bpy.data.objects:
        if _is_ours(obj.lamina_dust.image):
            found.append(_Slot("objects", obj, "", obj.lamina_dust.image))
    return found


def _is_ours(image):
    return image is not None and image.session_uid in data_image.made


def _blocks():
    return {block.session_uid for blocks in (bpy.data.node_groups, bpy.data.meshes) for block in blocks}


@persistent
def _before(*_):
    timers.with_right_to_write(let_go)


@persistent
def _after(*_):
    timers.with_right_to_write(take_again)


HANDLERS = {"undo_pre": _before, "redo_pre": _before, "undo_post": _after, "redo_post": _after}


def register():
    handlers.add(HANDLERS)


def unregister():
    handlers.remove(HANDLERS)
    _held.clear()
