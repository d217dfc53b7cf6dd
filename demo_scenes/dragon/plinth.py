# SPDX-License-Identifier: GPL-3.0-or-later
"""A turned plinth with a moulded edge, a closed surface with a mesh fine enough for the dust shadow of the figure."""

import numpy as np

# Outline from the middle of the top to the middle of the foot: radius and height, relative to the radius of the top.
PROFILE = ((1.0, 0.0), (1.025, -0.006), (1.04, -0.02), (1.04, -0.05), (1.0, -0.065), (0.985, -0.085), (1.0, -0.11),
           (1.05, -0.135), (1.09, -0.16), (1.1, -0.18), (1.1, -0.22))


def build(radius, step):
    """(vertices (n, 3), quadrangles (m, 4), triangles (k, 3)), oriented outwards. The top is the disc z = 0 of
    `radius`; edges are about `step` long."""
    corners = np.array([(0.004, 0.0), *PROFILE, (0.004, PROFILE[-1][1])]) * radius
    gaps = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(gaps)])
    at = np.unique(np.concatenate([np.linspace(0.0, along[-1], int(along[-1] / step)), along]))
    r, z = np.interp(at, along, corners[:, 0]), np.interp(at, along, corners[:, 1])
    sides = int(2.0 * np.pi * radius / (1.5 * step))
    angle = np.arange(sides) * 2.0 * np.pi / sides
    rings = len(at)
    points = np.stack([r[:, None] * np.cos(angle), r[:, None] * np.sin(angle),
                       np.broadcast_to(z[:, None], (rings, sides))], axis=-1).reshape(-1, 3)
    k, i = np.meshgrid(np.arange(rings - 1), np.arange(sides), indexing="ij")
    j = (i + 1) % sides
    quads = np.stack([k * sides + i, (k + 1) * sides + i, (k + 1) * sides + j, k * sides + j], axis=-1).reshape(-1, 4)
    ring, following, last = np.arange(sides), (np.arange(sides) + 1) % sides, (rings - 1) * sides
    triangles = np.concatenate([
        np.stack([ring, following, np.full(sides, rings * sides)], axis=1),
        np.stack([last + following, last + ring, np.full(sides, rings * sides + 1)], axis=1),
    ])
    ends = np.array([(0.0, 0.0, z[0]), (0.0, 0.0, z[-1])])
    return np.concatenate([points, ends]), quads, triangles
