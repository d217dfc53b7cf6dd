# SPDX-License-Identifier: GPL-3.0-or-later
"""Thin and pointed closed bodies as separate meshes: horns, teeth, claws, plates, fingers, membranes.

A shell is (vertices (n, 3), quadrangles (m, 4), triangles (k, 3)), oriented outwards; each edge has two faces.
"""

import numpy as np

from . import splines


def join(shells):
    """One shell made of several separate ones."""
    vertices, quads, triangles, first = [], [], [], 0
    for points, four, three in shells:
        vertices.append(points)
        quads.append(four + first)
        triangles.append(three + first)
        first += len(points)
    return np.concatenate(vertices), np.concatenate(quads), np.concatenate(triangles)


def swept(curve, sides=16, relief=None):
    """The tube along `curve`, whose values are the half axes along `side` and `up`, with a point at each end.

    relief(along, angle): factors on the radius; angle 0 is `side`, a quarter turn is `up`."""
    rings = len(curve.points)
    angle = np.arange(sides) * 2.0 * np.pi / sides
    factor = np.ones((rings, sides)) if relief is None else relief(curve.along[:, None], angle[None, :])
    a, b = curve.values[:, 0, None, None], curve.values[:, 1, None, None]
    cosine, sine = np.cos(angle)[None, :, None], np.sin(angle)[None, :, None]
    wheel = a * cosine * curve.side[:, None] + b * sine * curve.up[:, None]
    points = (curve.points[:, None] + factor[..., None] * wheel).reshape(-1, 3)
    ends = np.stack([
        curve.points[0] - 0.3 * curve.values[0, :2].min() * curve.tangent[0],
        curve.points[-1] + 0.6 * curve.values[-1, :2].min() * curve.tangent[-1],
    ])
    k, i = np.meshgrid(np.arange(rings - 1), np.arange(sides), indexing="ij")
    j = (i + 1) % sides
    quads = np.stack([k * sides + i, k * sides + j, (k + 1) * sides + j, (k + 1) * sides + i], axis=-1).reshape(-1, 4)
    ring, following = np.arange(sides), (np.arange(sides) + 1) % sides
    last = (rings - 1) * sides
    triangles = np.concatenate([
        np.stack([following, ring, np.full(sides, rings * sides)], axis=1),
        np.stack([last + ring, last + following, np.full(sides, rings * sides + 1)], axis=1),
    ])
    return np.concatenate([points, ends]), quads, triangles


def spike(base, towards, bend, length, radius, flat=1.0, *, sides=12, rings=14, relief=None, blunt=0.04, fullness=0.85):
    """A pointed, bent cone: from `base` along `towards`, with its point displaced by the vector `bend` (mm).

    radius: half width at the foot, across the bend; flat: the half axis along the bend over `radius`; fullness: < 1
    bulges, > 1 is slender."""
    base, towards, bend = np.asarray(base, float), splines.unit(np.asarray(towards, float)), np.asarray(bend, float)
    t = np.linspace(0.0, 1.0, 5)[:, None]
    size = np.maximum((1.0 - t[:, 0]) ** fullness, blunt) * radius
    up = bend if np.linalg.norm(bend) > 1e-6 else np.array([0.31, 0.62, 0.71])
    curve = splines.curve(base + length * t * towards + t * t * bend, up, np.stack([size, size * flat], axis=1),
                          step=1.02 * length / rings)
    return swept(curve, sides, relief)


def sheet(points, thickness):
    """A thin closed shell around the grid of points (rows, columns, 3); thickness (mm): a number or (rows, columns)."""
    rows, columns = points.shape[:2]
    normal = splines.unit(np.cross(np.gradient(points, axis=0), np.gradient(points, axis=1)))
    half = 0.5 * np.broadcast_to(np.asarray(thickness, float), (rows, columns))[..., None]
    vertices = np.concatenate([(points + half * normal).reshape(-1, 3), (points - half * normal).reshape(-1, 3)])
    r, c = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    a = r * columns + c
    top = np.stack([a, a + columns, a + columns + 1, a + 1], axis=-1).reshape(-1, 4)
    under = top[:, ::-1] + rows * columns
    loop = np.concatenate([
        np.arange(columns - 1), np.arange(rows - 1) * columns + columns - 1,
        (rows * columns - 1) - np.arange(columns - 1), (rows - 1 - np.arange(rows - 1)) * columns,
    ])
    following, other = np.roll(loop, -1), rows * columns
    rim = np.stack([loop, following, following + other, loop + other], axis=1)
    return vertices, np.concatenate([top, under, rim]), np.empty((0, 3), int)
