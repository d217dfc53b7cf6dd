# SPDX-License-Identifier: GPL-3.0-or-later
"""Sharp edges: groups of corners at a vertex that share a normal, and so a point of dust."""

from __future__ import annotations

import math

import numpy as np

from . import embree
from .mesh import Corners, Mesh, Points, unit_normals

SAME = math.radians(0.1)  # normals closer than this are equal
# An edge with exactly the limiting angle (a cylinder of twelve sides, at 30 degrees) is smooth, even if rounding of the
# normals makes the angle slightly larger.
SLACK = 1e-5
BLOCK = 1 << 18  # triangles at a time, to limit memory


def corners_of(mesh: Mesh) -> Corners:
    """The points of a checked mesh. Raises DustUnavailable."""
    count = len(mesh.vertices)
    given = mesh.normals
    by_corner = given is not None and given.ndim == 3
    if not by_corner and (given is not None or mesh.sharp_angle >= math.pi):
        first = np.full(count, -1, np.int64)
        flat = mesh.triangles.ravel()
        first[flat[::-1]] = np.arange(flat.size, dtype=np.int64)[::-1]
        return Corners(mesh.triangles, np.arange(count, dtype=np.uint32), first)
    if given is not None:
        normals, cosine = unit_normals(given.reshape(-1, 3)), math.cos(SAME)
    else:
        normals, cosine = _face_normals(mesh), math.cos(mesh.sharp_angle) - SLACK
    return Corners(*embree.layer().corner_points(mesh.triangles, normals, cosine, count))


def moved_off_edges(mesh: Mesh, points: Points, corners: Corners, distance: float) -> Points:
    """`points`, those of `corners`, with the points of split vertices moved by `distance` (in metres; less if the face
    is small) into one of their faces.

    Where walls meet in a groove, their common vertex lies in the planes of both, and a ray that starts off one wall
    along its normal may start behind the other. The point is moved into the face with its widest corner, along the
    bisector of this corner."""
    several = np.bincount(corners.vertex, minlength=len(mesh.vertices)) > 1
    if not several.any():
        return points
    positions = points.positions.copy()
    widest = np.zeros(len(positions))  # sine of half the angle of the corner that a point has moved into
    for first in range(0, len(mesh.triangles), BLOCK):
        triangle, corner = np.nonzero(several[mesh.triangles[first:first + BLOCK]])
        sine, move = _into_faces(mesh, triangle + first, corner, distance)
        target = corners.point[triangle + first, corner]
        order = np.lexsort((-np.arange(len(triangle)), sine, target))
        chosen = order[target[order] != np.append(target[order][1:], len(positions))]  # the last of each target
        chosen = chosen[sine[chosen] > widest[target[chosen]]]
        widest[target[chosen]] = sine[chosen]
        positions[target[chosen]] = points.positions[target[chosen]] + move[chosen]
    return Points(positions, points.normals, points.areas)


def _into_faces(mesh: Mesh, triangle: np.ndarray, corner: np.ndarray,
                distance: float) -> tuple[np.ndarray, np.ndarray]:
    """For (n,) corners of triangles: the sine of half the angle, 0 where the corner is too narrow or too wide to move
    into, and the step from the vertex into the face, (n, 3)."""
    place = mesh.vertices[mesh.triangles[triangle, corner]]
    sides = [mesh.vertices[mesh.triangles[triangle, (corner + k) % 3]] - place for k in (1, 2)]
    lengths = [np.linalg.norm(side, axis=1) for side in sides]
    wide = np.minimum(*lengths) > 0.0
    a, b = (np.divide(side, length[:, None], out=np.zeros_like(side), where=wide[:, None])
            for side, length in zip(sides, lengths, strict=True))
    middle = a + b
    spread = np.linalg.norm(middle, axis=1)  # 2 cos(angle / 2)
    sine = 0.5 * np.linalg.norm(a - b, axis=1)  # sin(angle / 2)
    usable = wide & (spread > 1e-6) & (sine > 1e-6)
    # A step of length 1 along the bisector covers the share 1 / (spread * length) of each side.
    across = np.divide(1.0, lengths[0], out=np.zeros_like(spread), where=usable) + np.divide(
        1.0, lengths[1], out=np.zeros_like(spread), where=usable)
    most = np.divide(0.25 * spread, across, out=np.zeros_like(spread), where=usable)
    step = np.minimum(np.divide(distance, sine, out=np.zeros_like(sine), where=usable), most)
    share = np.divide(step, spread, out=np.zeros_like(spread), where=usable)
    return np.where(usable, sine, 0.0), middle * share[:, None]


def _face_normals(mesh: Mesh) -> np.ndarray:
    """(m, 3) float32, of length 1, or 0 for triangles without area."""
    normals = np.empty(mesh.triangles.shape, np.float32)
    for first in range(0, len(normals), BLOCK):
        part = slice(first, first + BLOCK)
        a, b, c = (mesh.vertices[mesh.triangles[part, k]] for k in range(3))
        normals[part] = unit_normals(np.cross(b - a, c - a))
    return normals
