# SPDX-License-Identifier: GPL-3.0-or-later
"""Which meshes can keep dust off a surface. The others need no rays, so a scene of many objects settles in a time that
grows with what surrounds each object, and not with the whole scene."""

from __future__ import annotations

import math

import numpy as np

from .balance import LIFT, FallFrame
from .mesh import Mesh, used_vertices

MARGIN = 2.0 * LIFT  # by which a surface's box is enlarged, relative to its size: for the window of grains above it


def sheltering(surface: Mesh, occluders: list[Mesh], fall: FallFrame, reach: float) -> list[Mesh]:
    """Those of the checked `occluders` whose box meets the space that grains cross on their way to the box of
    `surface`, or comes within `reach` metres of this box."""
    axes = np.stack([fall.up, fall.across1, fall.across2], axis=1)
    low, high = _box(surface, axes)
    margin = MARGIN * float(np.linalg.norm(high - low))
    # Horizontal way of a grain per height, at most. Grains that pass through the window above the surface start as far
    # outside of its box as they may drift on its height.
    slope = math.tan(fall.spread) + math.hypot(fall.wind1, fall.wind2)
    drift = slope * (high[0] - low[0] + margin) + margin
    kept = []
    for mesh in occluders:
        bottom, top = _box(mesh, axes)
        gap = np.maximum(0.0, np.maximum(bottom - high, low - top))
        climb = top[0] - low[0] + margin
        is_above = climb >= 0.0 and math.hypot(gap[1], gap[2]) <= slope * climb + drift
        if is_above or float(np.linalg.norm(gap)) <= reach + margin:
            kept.append(mesh)
    return kept


def _box(mesh: Mesh, axes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The lowest and the highest coordinates of a mesh's faces along axes, (3,) each."""
    along = mesh.vertices[used_vertices(mesh)] @ axes
    return along.min(axis=0), along.max(axis=0)
