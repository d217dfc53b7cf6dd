# SPDX-License-Identifier: GPL-3.0-or-later
"""A cup with thin walls, a foot and a handle, about 18 mm wide; CC0."""

import functools

import numpy as np

from . import distance, isosurface

SPACING = 0.3
# A spherical shell, cut open at the top.
RADIUS, WALL, CENTRE, RIM = 8.0, 1.1, 9.5, 11.0
MARGIN = 1.0


def build(spacing=SPACING):
    """(vertices (n, 3) in mm, no quadrangles (0, 4), triangles (k, 3)), oriented outwards. spacing: of the grid, mm."""
    parts = [
        distance.Part(_shell, np.array([(-10.0, -10.0, 0.0), (10.0, 10.0, 13.0)]), 1.0),
        distance.bone((0.0, 0.0, 0.8), (0.0, 0.0, 1.4), 3.6, 2.6, 1.6),
        distance.Part(_handle, np.array([(5.0, -3.0, 2.0), (14.0, 3.0, 13.0)]), 1.2),
    ]
    box = np.array([(-10.0, -10.0, -3.0), (14.0, 10.0, 13.5)]) + np.array([[-MARGIN], [MARGIN]])
    vertices, triangles = isosurface.mesh(functools.partial(distance.melt, parts), box, spacing)
    return vertices, np.empty((0, 4), int), triangles


def _shell(points):
    """The wall, thinner towards the rim; the rim has three waves."""
    away = points - (0.0, 0.0, CENTRE)
    wall = np.abs(np.linalg.norm(away, axis=1) - RADIUS) - 0.5 * WALL * np.clip(1.5 - 0.08 * points[:, 2], 0.6, 1.5)
    rim = points[:, 2] - RIM - 0.7 * np.sin(3.0 * np.arctan2(away[:, 1], away[:, 0]))
    return -distance.smooth_minimum(-wall, -rim, 0.8)


def _handle(points):
    ring = np.hypot(points[:, 0] - 8.6, points[:, 2] - 7.4) - 3.4
    return np.hypot(ring, points[:, 1]) - 0.85
