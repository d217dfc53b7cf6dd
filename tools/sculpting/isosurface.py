# SPDX-License-Identifier: GPL-3.0-or-later
"""From a signed distance to a closed surface of even triangles: marching cubes of scikit-image, then relaxation."""

import numpy as np
from scipy import ndimage, sparse
from skimage import measure

BLOCK, BLOCKS_AT_ONCE = 8, 24
RELAXATIONS = 6


def mesh(distance, box, spacing):
    """(vertices (n, 3), triangles (m, 3), oriented outwards) of the surface where `distance` is zero.

    distance(points (n, 3), reach): accurate to some per cent below `reach` mm, and large beyond. box: (2, 3), must
    contain the surface. spacing: of the grid, in mm."""
    low = np.asarray(box[0], float)
    blocks = np.ceil((np.asarray(box[1], float) - low) / (spacing * BLOCK)).astype(int) + 1
    field = _sample(distance, low, blocks, spacing)
    field[[0, -1]] = field[:, [0, -1]] = field[:, :, [0, -1]] = spacing
    vertices, triangles, _, _ = measure.marching_cubes(field, 0.0, allow_degenerate=False)
    vertices = _relax(vertices.astype(float), triangles, field)
    return low + vertices * spacing, triangles.astype(int)


def normals(vertices, triangles):
    """Unit normals of vertices: means of the triangles' normals, weighted by area."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    across = np.repeat(np.cross(b - a, c - a), 3, axis=0)
    total = np.stack([np.bincount(triangles.ravel(), across[:, k], len(vertices)) for k in range(3)], axis=1)
    return total / np.linalg.norm(total, axis=1, keepdims=True)


def _sample(distance, low, blocks, spacing):
    """The distances on the grid; cells of blocks far from the surface get the distance of the block's middle."""
    middle = low + spacing * BLOCK * (np.stack(np.meshgrid(*map(np.arange, blocks), indexing="ij"), axis=-1) + 0.5)
    coarse = distance(middle.reshape(-1, 3), 3.0 * spacing * BLOCK).reshape(blocks)
    field = coarse.astype(np.float32)
    for axis in range(3):
        field = np.repeat(field, BLOCK, axis=axis)
    inner = np.stack(np.meshgrid(*[np.arange(BLOCK)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    near = np.argwhere(np.abs(coarse) < 1.5 * spacing * BLOCK)
    # Few blocks at a time, so that most bodies are far from all of them.
    for first in range(0, len(near), BLOCKS_AT_ONCE):
        index = (near[first : first + BLOCKS_AT_ONCE, None, :] * BLOCK + inner).reshape(-1, 3)
        field[tuple(index.T)] = distance(low + spacing * index, 5.0 * spacing)
    return field


def _relax(vertices, triangles, field):
    """Vertices distributed evenly over the surface: each is moved towards its neighbours' mean, then back along the
    gradient. In units of the grid."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    mean = sparse.csr_matrix((np.ones(len(edges)), edges.T), shape=(len(vertices),) * 2)
    mean = sparse.diags(1.0 / np.asarray(mean.sum(axis=1)).ravel()) @ mean
    gradient = [ndimage.sobel(field, axis=k, mode="nearest") / 32.0 for k in range(3)]
    for _ in range(RELAXATIONS):
        vertices = 0.4 * vertices + 0.6 * (mean @ vertices)
        d = ndimage.map_coordinates(field, vertices.T, order=1, mode="nearest")
        g = np.stack([ndimage.map_coordinates(part, vertices.T, order=1, mode="nearest") for part in gradient], axis=1)
        step = d / np.maximum(np.sum(g * g, axis=1), 1e-6)
        vertices = vertices - np.clip(step[:, None] * g, -0.5, 0.5)
    return vertices
