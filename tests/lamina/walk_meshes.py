# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed meshes to walk in."""

import numpy as np

import lamina

WIDE = 200.0  # mm, of a slab that stands for one without end


def box(low, high, **more):
    """A box of twelve triangles."""
    corners = np.array(np.meshgrid(*zip(low, high, strict=True), indexing="ij"), float).reshape(3, -1).T
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return lamina.Solid(corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]), **more)


def slab(thickness):
    """A wide slab below z = 0, and a point at its top with the normal."""
    solid = box((-0.5 * WIDE, -0.5 * WIDE, -thickness), (0.5 * WIDE, 0.5 * WIDE, 0.0))
    return solid, [[0.3, -0.2, 0.0]], [[0.0, 0.0, 1.0]]


def sphere(radius=1.0, divisions=4):
    """A sphere of 20 * 4^divisions triangles."""
    t = 0.5 * (1.0 + 5.0**0.5)
    vertices = np.array([[-1, t, 0], [1, t, 0], [-1, -t, 0], [1, -t, 0], [0, -1, t], [0, 1, t], [0, -1, -t], [0, 1, -t],
                         [t, 0, -1], [t, 0, 1], [-t, 0, -1], [-t, 0, 1]])
    faces = np.array([[0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2],
                      [10, 7, 6], [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5],
                      [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1]])
    for _ in range(divisions):
        edges = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
        pairs, place = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
        ab, bc, ca = place.reshape(3, -1) + len(vertices)
        vertices = np.vstack([vertices, vertices[pairs].mean(axis=1)])
        a, b, c = faces.T
        faces = np.vstack([np.column_stack(t) for t in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))])
    return lamina.Solid(radius * vertices / np.linalg.norm(vertices, axis=1)[:, None], faces)


def view(mu):
    """A direction of this cosine with z."""
    return [(1.0 - mu * mu) ** 0.5, 0.0, mu]
