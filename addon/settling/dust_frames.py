# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust at several frames: the frames, the memory that they need, and dust that follows an animation.

Following dust is kept as one attribute of the mesh for each settling. A modifier of Blender's own nodes, see
dust_playback, blends the two that are nearest in time into the attribute that materials read."""

import bpy
import numpy as np

from ..base.messages import RefusedError
from ..kinds.dust import ATTRIBUTE, BACK_ATTRIBUTE
from ..nodes import dust_playback
from . import dust_attribute

MOST_FRAMES = 1000
MOST_KEPT = 2 << 30  # bytes of attributes in the file
MOST_GATHERED = 4 << 30  # bytes of meshes of all frames


def wanted(settings):
    """The frames at which dust settles, a range; None for the present frame alone. Raises RefusedError."""
    if not settings.over_frames:
        return None
    first, last = settings.frame_first, settings.frame_last
    if last < first:
        raise RefusedError(f"Last Frame = {last}: must be at least First Frame, {first}")
    frames = range(first, last + 1, settings.frame_step)
    if len(frames) > MOST_FRAMES:
        raise RefusedError(f"{len(frames)} frames: at most {MOST_FRAMES} can be settled; raise Frame Step")
    if settings.frames_as == "follow" and settings.target == "image":
        raise RefusedError("Dust that follows an animation needs an attribute: choose it under Where To")
    return frames


def visited(scene, frames):
    """Goes through `frames`, counted at the cursor, and back to the present frame; None: stays there."""
    if frames is None:
        yield scene.frame_current
        return
    now, manager = (scene.frame_current, scene.frame_subframe), bpy.context.window_manager
    manager.progress_begin(0, len(frames))
    try:
        for number, frame in enumerate(frames):
            manager.progress_update(number)
            scene.frame_set(frame)
            yield frame
    finally:
        manager.progress_end()
        scene.frame_set(now[0], subframe=now[1])


def kept_bytes(mesh, settings):
    """Most memory in bytes, and in the file before compression, of following dust; raises as `wanted`."""
    frames = wanted(settings)
    return _kept(len(mesh.loops), len(mesh.vertices), len(frames) if frames is not None else 0, settings)


def _kept(corners, vertices, frames, settings):
    return 4 * max(corners, vertices) * (frames + 1) * (2 if settings.two_sided else 1)


class Budget:
    """The memory of a settling at several frames. Methods raise RefusedError when it becomes too much."""

    def __init__(self, settings, follows):
        self._settings, self._follows, self._gathered = settings, follows, 0

    def add(self, surface, own, occluders):
        """The arrays of one frame, without the occluders that it shares with the frame before."""
        if self._follows is not None:
            count = len(self._follows)
            kept = _kept(len(own.corners), len(own.vertices), count, self._settings)
            if kept > MOST_KEPT:
                raise RefusedError(f"Dust at {count} frames needs {size(kept)}: at most {size(MOST_KEPT)}; "
                                   "raise Frame Step")
        for arrays in (surface, own, *occluders):
            parts = vars(arrays).values()
            self._gathered += sum(one.nbytes for one in parts if isinstance(one, np.ndarray))
        if self._gathered > MOST_GATHERED:
            text = f"The meshes of all frames need more than {size(MOST_GATHERED)}"
            raise RefusedError(f"{text}: raise Frame Step")


def size(number):
    """A number of bytes in words."""
    return f"{number / 1e9:.1f} GB" if number >= 1e9 else f"{max(number / 1e6, 0.1):.1f} MB"


def shared(occluders, before):
    """Occluders, with those of the frame before in place of equal ones, so that what rests is held once."""
    known = {one.name: one for one in before}
    return [known[one.name] if _is_equal(one, known.get(one.name)) else one for one in occluders]


def _is_equal(one, other):
    return other is not None and np.array_equal(one.vertices, other.vertices) and np.array_equal(
        one.triangles, other.triangles)


def check_same_points(dusts):
    """Raises RefusedError unless all moments' dust lies on the same points."""
    for number, dust in enumerate(dusts):
        if dust.tau.shape != dusts[0].tau.shape or not np.array_equal(dust.corners, dusts[0].corners):
            text = f"At settling {number + 1} the mesh has other vertices, faces or sharp edges than at first"
            raise RefusedError(f"{text}: dust can follow only a mesh that keeps them")


def write(obj, moments, dusts, frames):
    """Store the dust of all frames on the object's own mesh, and play it back by a modifier."""
    mesh = obj.data
    places = [dust_attribute.Places(moment.surface, moment.own, dust)
              for moment, dust in zip(moments, dusts, strict=True)]
    split = any(one.split for one in places)
    dust_attribute.remove(mesh)
    keys = (dust_playback.KEY, dust_playback.BACK_KEY)
    for number, (place, dust) in enumerate(zip(places, dusts, strict=True)):
        dust_attribute.store(mesh, [f"{key}{number}" for key in keys], place, dust, split)
    # Without the modifier, for example in Edit Mode, the first frame is seen.
    dust_attribute.store(mesh, (ATTRIBUTE, BACK_ATTRIBUTE), places[0], dusts[0], split)
    mesh.update()
    dust_playback.add(obj, frames, "CORNER" if split else "POINT", dusts[0].back is not None)


def remove(obj):
    """Remove the settlings of following dust and the modifier. The last dust of the mesh itself stays."""
    dust_playback.remove(obj)
    keys = (dust_playback.KEY, dust_playback.BACK_KEY)
    for name in [one.name for one in obj.data.attributes if one.name.startswith(keys)]:
        obj.data.attributes.remove(obj.data.attributes[name])
