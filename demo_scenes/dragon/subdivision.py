# SPDX-License-Identifier: GPL-3.0-or-later
"""One step of Catmull and Clark (1978) on a closed surface of quadrangles, and its normals."""

import numpy as np

from . import splines


def catmull_clark(vertices, quads):
    """(vertices, quadrangles) of the surface subdivided once; the old vertices come first."""
    count = len(vertices)
    face = vertices[quads].mean(axis=1)
    start, end = quads, np.roll(quads, -1, axis=1)
    key = np.minimum(start, end) * count + np.maximum(start, end)
    unique, number, faces_of = np.unique(key, return_inverse=True, return_counts=True)
    if np.any(faces_of != 2):
        raise ValueError(f"edges: {np.count_nonzero(faces_of != 2)} of them do not have exactly two faces")
    number = number.reshape(quads.shape)
    a, b = unique // count, unique % count
    middle = 0.5 * (vertices[a] + vertices[b])
    edge = 0.5 * middle + 0.25 * _sum(number.ravel(), np.repeat(face, 4, axis=0), len(unique))
    valence = np.bincount(quads.ravel(), minlength=count)[:, None].astype(float)
    valence[valence == 0.0] = 1.0
    of_faces = _sum(quads.ravel(), np.repeat(face, 4, axis=0), count) / valence
    of_edges = (_sum(a, middle, count) + _sum(b, middle, count)) / valence
    moved = (of_faces + 2.0 * of_edges + (valence - 3.0) * vertices) / valence
    e, f = count + number, count + len(unique) + np.arange(len(quads))
    finer = np.stack([np.stack([quads[:, k], e[:, k], f, e[:, k - 1]], axis=1) for k in range(4)], axis=1)
    return np.concatenate([moved, edge, face]), finer.reshape(-1, 4)


def normals(vertices, quads):
    """Unit normals of vertices: means of the faces' normals, weighted by area."""
    a, b, c, d = (vertices[quads[:, k]] for k in range(4))
    across = np.cross(c - a, d - b)
    return splines.unit(_sum(quads.ravel(), np.repeat(across, 4, axis=0), len(vertices)))


def _sum(index, values, count):
    return np.stack([np.bincount(index, values[:, k], count) for k in range(3)], axis=1)
