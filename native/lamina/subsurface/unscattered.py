# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that crosses a body without scattering. Cycles' Subsurface Scattering node spreads this light over all
directions, as if it had scattered."""

from __future__ import annotations

import math

import numpy as np

from ..material.millimetres import depth_knots
from ..material.stack import Stack

MOST_UNSCATTERED = 0.25  # largest share of the light for which the node is fit


def unscattered_share(paths: float) -> float:
    """The share of light from all directions that crosses a ball, `paths` mean free paths wide, without scattering:
    the mean of exp(-paths cos) over the cosine-weighted directions of entry."""
    if paths < 1e-3:
        return 1.0 - 2.0 / 3.0 * paths
    return 2.0 / paths**2 * (1.0 - (1.0 + paths) * math.exp(-paths))


def mean_width(vertices: np.ndarray, triangles: np.ndarray) -> float:
    """Six times the volume over the area of a closed mesh: the diameter of a ball. Shapes (n, 3) and (m, 3)."""
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    middle = corners.reshape(-1, 3).mean(axis=0)
    volume = np.einsum("ij,ij->", corners[:, 0] - middle, normals) / 6.0
    return float(6.0 * volume / (0.5 * np.linalg.norm(normals, axis=1).sum()))


def largest_extinction(stack: Stack) -> float:
    """The largest sigma_t of the stack's media in 1/mm, over channels and depths; 0 without a medium. Raises StackError
    as depth_knots does."""
    return max((knot.sigma_t for index in range(stack.channels) for knots in depth_knots(stack, index)
                for knot in knots), default=0.0)
