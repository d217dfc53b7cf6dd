# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes with known dust, and others that are difficult for settling."""

import numpy as np

from lamina.dust import Mesh


def plate(cells=8, size=1.0, height=0.0, centre=(0.0, 0.0)):
    """A square, z up, of 2 cells^2 triangles."""
    line = np.linspace(-0.5 * size, 0.5 * size, cells + 1)
    x, y = np.meshgrid(line + centre[0], line + centre[1], indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, height)])
    return Mesh(vertices, _grid(cells, cells))


def sphere(rows=32, columns=64, radius=1.0):
    """Closed; poles on z."""
    theta = np.linspace(0.0, np.pi, rows + 1)[1:-1]
    phi = 2.0 * np.pi * np.arange(columns) / columns
    ring = np.stack([np.outer(np.sin(theta), np.cos(phi)), np.outer(np.sin(theta), np.sin(phi)),
                     np.outer(np.cos(theta), np.ones(columns))], axis=-1).reshape(-1, 3)
    vertices = np.vstack([ring, [[0, 0, 1], [0, 0, -1]]]) * radius
    k = np.arange(columns)
    after = (k + 1) % columns
    triangles = [np.column_stack([np.full(columns, len(ring)), k, after])]
    for row in range(rows - 2):
        a, b = row * columns + k, row * columns + after
        c, d = a + columns, b + columns
        triangles += [np.column_stack([a, c, b]), np.column_stack([b, c, d])]
    last = (rows - 2) * columns
    triangles.append(np.column_stack([np.full(columns, len(ring) + 1), last + after, last + k]))
    return Mesh(vertices, np.vstack(triangles))


def torus(around=96, across=48, radius=1.0, tube=0.4, ripple=0.0):
    """Closed, in the plane z = 0; `ripple` bumps its tube."""
    u = 2.0 * np.pi * np.arange(around) / around
    v = 2.0 * np.pi * np.arange(across) / across
    u, v = np.meshgrid(u, v, indexing="ij")
    tube = tube * (1.0 + ripple * np.sin(11 * u) * np.sin(7 * v))
    vertices = np.stack([(radius + tube * np.cos(v)) * np.cos(u), (radius + tube * np.cos(v)) * np.sin(u),
                         tube * np.sin(v)], axis=-1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    a = i * across + j
    b = (i + 1) % around * across + j
    c = (i + 1) % around * across + (j + 1) % across
    d = i * across + (j + 1) % across
    return Mesh(vertices, np.vstack([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)]))


def box(low, high):
    """Closed, with eight vertices."""
    corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return Mesh(corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]))


def subdivided(mesh):
    """Each triangle in four; the old vertices keep their numbers."""
    edges = np.sort(np.vstack([mesh.triangles[:, pair] for pair in ([0, 1], [1, 2], [2, 0])]), axis=1)
    unique, place = np.unique(edges, axis=0, return_inverse=True)
    middle = len(mesh.vertices) + place.reshape(3, -1)
    a, b, c = mesh.triangles.T
    ab, bc, ca = middle
    vertices = np.vstack([mesh.vertices, mesh.vertices[unique].mean(axis=1)])
    return Mesh(vertices, np.vstack([np.column_stack(t) for t in
                                     ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))]))


def moved(mesh, rotation=None, shift=(0.0, 0.0, 0.0), scale=1.0):
    rotation = np.eye(3) if rotation is None else rotation
    return Mesh(scale * mesh.vertices @ np.asarray(rotation).T + np.asarray(shift), mesh.triangles)


def _grid(rows, columns):
    i, j = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    a = (i * (columns + 1) + j).ravel()
    b, c, d = a + columns + 1, a + columns + 2, a + 1
    return np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
