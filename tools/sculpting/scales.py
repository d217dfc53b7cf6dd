# SPDX-License-Identifier: GPL-3.0-or-later
"""Scales as a relief: shields that overlap towards the tail and the toes, and broad plates under neck and belly.

Along the spine, shields stand in staggered rows. Between and on the limbs they fill the remaining space.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from . import splines

NEIGHBOURS = 10
DEPTH = 0.21  # relative to the length of a shield
PLATE_ANGLE = np.radians(52.0)  # angle from the middle of the underside to the edge of the plates


@dataclass(frozen=True)
class Grain:
    """Direction and size of shields near a limb, at points along it: (n, 3), (n, 3), (n,) mm."""

    points: np.ndarray
    towards: np.ndarray  # direction of the shields' free ends
    sizes: np.ndarray  # length of a shield; 0 for none


def relief(vertices, normals, grain, rows, smooth, seed):
    """Heights (n,) in mm over the surface's vertices.

    rows: (points, sizes) of shields in rows, at a small distance from the surface; smooth (n,): 0 for bare skin, up to
    1."""
    nearest = cKDTree(grain.points).query(vertices)[1]
    size = grain.sizes[nearest]
    centres = _centres(vertices, size, smooth, rows, seed)
    # Direct shields towards the limb's end, along the surface.
    flow = grain.towards[nearest[centres]]
    normal = normals[centres]
    along = splines.unit(flow - np.sum(flow * normal, axis=1, keepdims=True) * normal)
    across = np.cross(normal, along)
    return smooth * _shields(vertices, normals, vertices[centres], normal, along, across, size[centres])


def _centres(vertices, size, smooth, rows, seed):
    """Indices of vertices with shields: first those in rows, then others, with a least distance between shields."""
    tree = cKDTree(vertices)
    off, at = tree.query(rows[0])
    in_row = at[off < 2.5]
    rng = np.random.default_rng(seed)
    strewn = rng.permutation(len(vertices))[: 40000]
    order = np.concatenate([in_row, strewn])
    radius = np.concatenate([np.full(len(in_row), 0.55), np.full(len(strewn), 0.80)]) * size[order]
    candidates = cKDTree(vertices[order])
    taken = (smooth[order] < 0.05) | (size[order] <= 0.0)
    chosen = []
    for k in range(len(order)):
        if not taken[k]:
            chosen.append(order[k])
            # Scattered shields keep a larger distance from shields in rows than shields in rows from each other.
            near = np.array(candidates.query_ball_point(vertices[order[k]], 0.80 * size[order[k]]))
            inner = np.linalg.norm(vertices[order[near]] - vertices[order[k]], axis=1) < radius[near]
            taken[near[inner]] = True
    return np.array(chosen)


def _shields(vertices, normals, centres, normal, along, across, size):
    """The height of the highest shield at each vertex."""
    index = cKDTree(centres).query(vertices, NEIGHBOURS)[1]
    height = np.zeros(len(vertices))
    for k in range(NEIGHBOURS):
        j = index[:, k]
        q = (vertices - centres[j]) / size[j, None]
        x, y = np.sum(q * along[j], axis=1), np.sum(q * across[j], axis=1)
        # The outline of a leaf with its point at x = .75 and its root at -.75.
        half = 0.60 * np.sqrt(np.clip(1.0 - (x / 0.78) ** 2, 0.0, None)) * (1.0 - 0.22 * x)
        inside = np.minimum((half - np.abs(y)) / 0.10, 1.0)
        rise = 0.25 + 0.75 * np.clip((x + 0.75) / 1.5, 0.0, 1.0)
        keel = 0.22 * np.clip(1.0 - np.abs(y) / 0.12, 0.0, 1.0) * (1.0 - np.clip(np.abs(x) / 0.7, 0, 1) ** 2)
        dome = 0.16 * (1.0 - np.clip(np.abs(y) / 0.6, 0, 1) ** 2)
        here = np.where(inside > 0.0, np.clip(inside, 0.0, 1.0) * (rise + keel + dome), 0.0)
        # Leave out the other side of a thin part, which has its own shields.
        here *= np.sum(normals * normal[j], axis=1) > 0.2
        height = np.maximum(height, here * DEPTH * size[j])
    return height


def rows_along(curve, stretches):
    """(points, sizes) of shields in staggered rows around `curve`; stretches: (from mm, to mm, number around)."""
    points, sizes = [], []
    for first, last, around in stretches:
        at, odd = first, 0
        while at < last:
            k = min(int(np.searchsorted(curve.along, at)), len(curve.points) - 1)
            a, b = curve.values[k, :2]
            size = np.pi * (a + b) / around
            angle = (np.arange(around) + 0.5 * odd) * 2.0 * np.pi / around + 0.5 * np.pi
            points.append(curve.points[k] + np.outer(a * np.cos(angle), curve.side[k])
                          + np.outer(b * np.sin(angle), curve.up[k]))
            sizes.append(np.full(around, size))
            at, odd = at + 0.80 * size, 1 - odd
    return np.concatenate(points), np.concatenate(sizes)


def plates(vertices, curve, pitch):
    """(heights (n,) mm, share of plate (n,)) at each vertex, of broad plates under `curve`.

    pitch: length of a plate relative to the local radius."""
    k = cKDTree(curve.points).query(vertices)[1]
    q = vertices - curve.points[k]
    ahead = np.sum(q * curve.tangent[k], axis=1)
    u, v = np.sum(q * curve.side[k], axis=1), np.sum(q * curve.up[k], axis=1)
    a, b = curve.values[k, 0], curve.values[k, 1]
    angle = np.abs(np.arctan2(u / a, -v / b))
    out = np.hypot(u / a, v / b)
    radius = 0.5 * (curve.values[:, 0] + curve.values[:, 1])
    step = pitch * np.maximum(radius, 2.0)
    counted = np.concatenate([[0.0], np.cumsum(0.5 * (1.0 / step[1:] + 1.0 / step[:-1]) * np.diff(curve.along))])
    phase = np.interp(curve.along[k] + ahead, curve.along, counted) - 0.35 * (angle / PLATE_ANGLE) ** 2
    part = phase - np.floor(phase)
    profile = splines.smoothstep(0.0, 0.14, part) * (1.0 - 0.85 * part) + 0.12
    share = (1.0 - splines.smoothstep(0.9, 1.0, angle / PLATE_ANGLE)) * (1.0 - splines.smoothstep(1.15, 1.35, out))
    return share * profile * 0.16 * step[k], share
