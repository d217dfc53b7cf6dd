# SPDX-License-Identifier: GPL-3.0-or-later
"""From a signed distance to a closed surface of quadrangles: surface nets (Gibson, MERL TR99-24, 1999).

Each grid cell that the surface crosses has one vertex, each crossed edge one quadrangle. Every edge has exactly two
faces, since cells whose corners alternate in sign are filled first.
"""

import numpy as np
from scipy import ndimage

BLOCK, BLOCKS_AT_ONCE = 8, 24


def mesh(distance, box, spacing, relaxations=6):
    """(vertices (n, 3), quadrangles (m, 4), oriented outwards) of the surface where `distance` is zero.

    distance(points (n, 3), reach): accurate to some per cent below `reach` mm, and large beyond. box: (2, 3), must
    contain the surface."""
    low = np.asarray(box[0], float)
    blocks = np.ceil((np.asarray(box[1], float) - low) / (spacing * BLOCK)).astype(int) + 1
    field = _sample(distance, low, blocks, spacing)
    field[[0, -1]] = field[:, [0, -1]] = field[:, :, [0, -1]] = spacing
    _fill_alternating_faces(field)
    vertices, quads = _nets(field)
    vertices = _relax(vertices, quads, field, relaxations)
    return low + vertices * spacing, quads


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


def _fill_alternating_faces(field):
    while True:
        filled = 0
        for a, b in ((0, 1), (0, 2), (1, 2)):
            cut = [[slice(None)] * 3 for _ in range(4)]
            for k in range(4):
                cut[k][a] = slice(1, None) if k & 1 else slice(None, -1)
                cut[k][b] = slice(1, None) if k & 2 else slice(None, -1)
            corner = [field[tuple(c)] for c in cut]
            inside = [c < 0.0 for c in corner]
            alternating = (inside[0] == inside[3]) & (inside[1] == inside[2]) & (inside[0] != inside[1])
            filled += int(alternating.sum())
            for c in corner:
                c[alternating & (c >= 0.0)] = -1e-3
        if not filled:
            return


def _nets(field):
    """Vertices in units of the grid, and quadrangles."""
    inside = field < 0.0
    # Per cell: the sum and the number of the points where its twelve edges cross the surface.
    shape = tuple(n - 1 for n in field.shape)
    corners = sum(inside[i : i + shape[0], j : j + shape[1], k : k + shape[2]].astype(np.int8)
                  for i in (0, 1) for j in (0, 1) for k in (0, 1))
    cells = np.argwhere((corners > 0) & (corners < 8))
    number = np.full(shape, -1, np.int64)
    number[tuple(cells.T)] = np.arange(len(cells))
    total, count = np.zeros((len(cells), 3)), np.zeros(len(cells))
    for axis in range(3):
        step = np.eye(3, dtype=int)[axis]
        for offset in _offsets(axis):
            start = cells + offset
            a, b = field[tuple(start.T)], field[tuple((start + step).T)]
            crosses = (a < 0.0) != (b < 0.0)
            t = np.where(crosses, a / np.where(crosses, a - b, 1.0), 0.0)
            total += np.where(crosses[:, None], start + t[:, None] * step, 0.0)
            count += crosses
    quads = []
    for axis in range(3):
        step = np.eye(3, dtype=int)[axis]
        ends = tuple(slice(1, None) if k == axis else slice(None) for k in range(3))
        starts = tuple(slice(None, -1) if k == axis else slice(None) for k in range(3))
        edge = np.argwhere(inside[starts] != inside[ends])
        p, q = np.roll(np.eye(3, dtype=int), -axis - 1, axis=0)[:2]
        around = [number[tuple((edge - o).T)] for o in (p * 0, p, p + q, q)]
        leaving = inside[tuple(edge.T)]
        assert step @ np.cross(p, q) == 1
        quad = np.stack(around, axis=1)
        quads.append(np.where(leaving[:, None], quad, quad[:, ::-1]))
    return total / count[:, None], np.concatenate(quads)


def _offsets(axis):
    """First corners of a cell's four edges along `axis`."""
    others = [k for k in range(3) if k != axis]
    for i in (0, 1):
        for j in (0, 1):
            offset = np.zeros(3, int)
            offset[others[0]], offset[others[1]] = i, j
            yield offset


def _relax(vertices, quads, field, times):
    """Vertices distributed evenly over the surface: each is moved towards its neighbours' mean, then back along the
    gradient."""
    gradient = [ndimage.sobel(field, axis=k, mode="nearest") / 32.0 for k in range(3)]
    for _ in range(times):
        vertices = 0.4 * vertices + 0.6 * neighbour_mean(vertices, quads)
        at = vertices.T
        d = ndimage.map_coordinates(field, at, order=1, mode="nearest")
        g = np.stack([ndimage.map_coordinates(part, at, order=1, mode="nearest") for part in gradient], axis=1)
        step = d / np.maximum(np.sum(g * g, axis=1), 1e-6)
        step = np.clip(step[:, None] * g, -0.5, 0.5)
        vertices = vertices - step
    return vertices


def neighbour_mean(vertices, quads):
    """The mean of each vertex's neighbours along edges."""
    total, count = np.zeros_like(vertices), np.zeros(len(vertices))
    for k in range(4):
        a, b = quads[:, k], quads[:, (k + 1) % 4]
        for axis in range(3):
            total[:, axis] += np.bincount(a, vertices[b, axis], len(vertices))
        count += np.bincount(a, minlength=len(vertices))
    return total / count[:, None]
