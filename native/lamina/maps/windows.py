# SPDX-License-Identifier: GPL-3.0-or-later
"""The neighbours of each point of a map: of a texel, within a square of the image; of a vertex, along edges.

Two sizes: narrow windows, 4 texels or edges to each side, and windows that are 3 times as wide with as many points."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .places import Places, frames_about

REACH = 4  # texels or edges to each side
WIDER = 3
FACING = 0.5  # least cosine between normals of neighbours
FAR = 3.0  # a neighbour may be so many times as far away as its distance in texels says
MOST_EDGES, NEXT, NEAR = 12, 20, 80  # neighbours of a vertex: along edges, within two edges, within four
ROWS = 1 << 14  # vertices at a time, because of the memory


class Window:
    """The weighted neighbours of each point. `members` yields some 80 of them in turn, for all points at once: (the
    neighbours' numbers; their weights; their places along two tangents, relative to the window's size, (points, 2)). A
    weight is 0, and the number any, where there is no such neighbour on the same part of the surface."""

    def members(self) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        raise NotImplementedError

    def mean(self, values: np.ndarray) -> np.ndarray:
        """The weighted mean over each window of values (points, n)."""
        total, weights = np.zeros_like(values), np.zeros((len(values), 1))
        for other, weight, _ in self.members():
            total += weight[:, None] * values[other]
            weights += weight[:, None]
        return total / weights


def windows(places: Places) -> tuple[Window, Window]:
    """The narrow and the wide windows."""
    if places.is_image:
        texels = _Texels(places)
        return _OfTexels(texels, 1), _OfTexels(texels, WIDER)
    vertices = _Vertices(places)
    return _OfVertices(vertices, vertices.near, REACH), _OfVertices(vertices, vertices.far(), WIDER * REACH)


class _Texels:
    """`number` of each texel, with a margin; the texels' `rows` and `columns` there; their `size` in mm."""

    def __init__(self, places: Places):
        margin, mask = REACH * WIDER, places.mask
        self.number = np.full(tuple(side + 2 * margin for side in mask.shape), -1)
        self.number[margin:-margin, margin:-margin][mask] = np.arange(int(mask.sum()))
        self.rows, self.columns = (index + margin for index in np.nonzero(mask))
        self.positions, self.normals = places.points.positions, places.points.normals
        self.size = self._size()

    def at(self, y: int, x: int) -> tuple[np.ndarray, np.ndarray]:
        """(number of the texel at this offset from each, or -1; its distance in mm)."""
        other = self.number[self.rows + y, self.columns + x]
        return other, np.linalg.norm(self.positions[other] - self.positions, axis=1)

    def _size(self) -> np.ndarray:
        """The larger of the distances in mm to the next texels to the right and above, or the median where none is."""
        steps = np.zeros((2, len(self.rows)))
        for axis, (y, x) in enumerate(((0, 1), (1, 0))):
            for sign in (1, -1):
                other, away = self.at(sign * y, sign * x)
                steps[axis] = np.where((other >= 0) & (steps[axis] == 0.0), away, steps[axis])
        usual = np.median(steps[steps > 0.0]) if (steps > 0.0).any() else 0.0
        steps = np.where(steps > 0.0, steps, usual)
        return np.minimum(steps.max(axis=0), FAR * usual)


class _OfTexels(Window):
    def __init__(self, texels: _Texels, step: int):
        self._texels, self._step = texels, step

    def members(self):
        lengths = np.linalg.norm(self._texels.normals, axis=1)
        for y in range(-REACH, REACH + 1):
            for x in range(-REACH, REACH + 1):
                other, distance = self._texels.at(self._step * y, self._step * x)
                found, away = other >= 0, float(np.hypot(y, x))
                other = np.where(found, other, 0)
                facing = np.einsum("ij,ij->i", self._texels.normals[other], self._texels.normals)
                found &= (distance <= FAR * away * self._step * self._texels.size) & (facing >= FACING * lengths)
                place = np.broadcast_to(np.array([x, y]) / REACH, (len(other), 2))
                yield other, found * np.exp(-0.5 * (away / (0.5 * REACH)) ** 2), place


class _Vertices:
    """`near`: numbers of the 80 nearest vertices within four edges, (vertices, 80). The first is the vertex itself, and
    so are those that are missing where there are fewer. `edge`: mean length of the edges of each vertex, in mm."""

    def __init__(self, places: Places):
        self.positions, self.normals = places.points.positions, places.points.normals
        count = len(self.positions)
        number = np.full(len(places.mask), -1)
        number[places.mask] = np.arange(count)
        pairs = number[places.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)]
        pairs = pairs[(pairs >= 0).all(axis=1)]
        pairs = np.unique(np.concatenate([pairs, pairs[:, ::-1]]), axis=0)
        rank = np.arange(len(pairs)) - np.searchsorted(pairs[:, 0], pairs[:, 0])
        pairs, rank = pairs[rank < MOST_EDGES], rank[rank < MOST_EDGES]
        along = np.tile(np.arange(count)[:, None], MOST_EDGES)
        along[pairs[:, 0], rank] = pairs[:, 1]
        lengths = np.linalg.norm(self.positions[along] - self.positions[:, None], axis=2)
        self.edge = lengths.sum(axis=1) / np.maximum((lengths > 0.0).sum(axis=1), 1)
        self.near = self._nearest(self._nearest(along, NEXT), NEAR)

    def far(self) -> np.ndarray:
        """Numbers of 80 vertices, most of them within twelve edges: random walks over `near`, the same ones everywhere.
        """
        columns = np.random.default_rng(0).integers(NEAR, size=(WIDER**2, NEAR))
        columns[:, 0] = 0  # the vertex itself
        found = np.tile(np.arange(len(self.near))[:, None], NEAR)
        for step in columns:
            found = self.near[found, step]
        return found

    def _nearest(self, along: np.ndarray, most: int) -> np.ndarray:
        """The `most` nearest of the neighbours of neighbours `along`, (vertices, n)."""
        found = np.empty((len(along), most), along.dtype)
        itself = np.arange(len(along))[:, None]
        for first in range(0, len(along), ROWS):
            rows = itself[first:first + ROWS]
            ways = along[np.hstack([rows, along[first:first + ROWS]])].reshape(len(rows), -1)
            ways = np.sort(np.hstack([rows, ways]), axis=1)
            distance = np.linalg.norm(self.positions[ways] - self.positions[rows], axis=2)
            distance[:, 1:][ways[:, 1:] == ways[:, :-1]] = np.inf
            distance[ways == rows] = np.inf
            nearest = np.argsort(distance, axis=1)[:, :most - 1]
            near = np.where(np.isinf(np.take_along_axis(distance, nearest, 1)), rows,
                            np.take_along_axis(ways, nearest, 1))
            found[first:first + ROWS] = np.hstack([rows, near])
        return found


class _OfVertices(Window):
    def __init__(self, vertices: _Vertices, members: np.ndarray, edges: int):
        self._vertices, self._members = vertices, members
        self._size = edges * np.maximum(vertices.edge, 1e-30)
        self._tangents = frames_about(vertices.normals)[:, :2]

    def members(self):
        itself = np.arange(len(self._members))
        for k, other in enumerate(self._members.T):
            apart = (self._vertices.positions[other] - self._vertices.positions) / self._size[:, None]
            facing = np.einsum("ij,ij->i", self._vertices.normals[other], self._vertices.normals)
            square = np.einsum("ij,ij->i", apart, apart)
            found = ((facing >= FACING) & (square <= 1.0) & (other != itself)) | (k == 0)
            weight = found * np.exp(-2.0 * square)
            yield other, weight, np.einsum("nij,nj->ni", self._tangents, apart)
