# SPDX-License-Identifier: GPL-3.0-or-later
"""The orthographic camera, and the points of the body that its pixels see."""

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Vector
from slab.light import frame

FAR = 60.0  # mm from the middle of the picture to the eye
INSIDE = 1e-4  # mm by which a ray starts off the surface


@dataclass(frozen=True, eq=False)
class Seen:
    """The points that the rays of a picture meet. `hit`: bool (rays,); the others have one row per hit."""

    hit: np.ndarray
    points: np.ndarray  # mm
    normals: np.ndarray  # of the faces


def build(scene, body):
    """Add the camera to `scene`."""
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale, camera.clip_end = "ORTHO", body.width, 2.0 * FAR
    eye = bpy.data.objects.new("camera", camera)
    scene.collection.objects.link(eye)
    eye.matrix_world = frame(body.towards_eye)
    eye.location = body.middle + FAR * body.towards_eye
    scene.camera = eye


def seen(body, tree, size, offsets):
    """Seen for the pixels of a square picture, first row on top.

    `offsets`: positions within a pixel, (k, 2), each coordinate 0 to 1; the rays are ordered by pixel, then by offset.
    """
    turn = np.array(frame(body.towards_eye))[:3, :3]
    offsets = np.asarray(offsets, float)
    rows, columns = np.divmod(np.arange(size * size), size)
    x = ((columns[:, None] + offsets[:, 0]) / size - 0.5).ravel() * body.width
    y = (0.5 - (rows[:, None] + offsets[:, 1]) / size).ravel() * body.width
    starts = np.array(body.middle) + np.outer(x, turn[:, 0]) + np.outer(y, turn[:, 1]) + FAR * turn[:, 2]
    found = [tree.ray_cast(Vector(start), -body.towards_eye) for start in starts]
    hit = np.array([one[0] is not None for one in found])
    points, normals = (np.array([one[k] for one in found if one[0] is not None]).reshape(-1, 3) for k in (0, 1))
    return Seen(hit, points, normals)


def region(body, tree, size):
    """The pixels whose middle and corners all see the body: bool (size, size)."""
    return seen(body, tree, size, [(0.5, 0.5), (0, 0), (0, 1), (1, 0), (1, 1)]).hit.reshape(size, size, 5).all(axis=2)


def lengths(tree, points, directions):
    """Distance (mm) from each point along its unit direction to the next face; infinite without one."""
    found = np.full(len(points), np.inf)
    for k, (point, direction) in enumerate(zip(points, directions, strict=True)):
        along = Vector(direction)
        way = tree.ray_cast(Vector(point) + INSIDE * along, along)[3]
        if way is not None:
            found[k] = way + INSIDE
    return found
