# SPDX-License-Identifier: GPL-3.0-or-later
"""The neighbours of each point of a map: of a texel, within a square of the image; of a vertex, along edges.

Two sizes: narrow windows, 4 texels or edges to each side, and windows that are 3 times as wide with as many points."""

from __future__ import annotations

import numpy as np

from .. import _core
from .places import Places, frames_about

REACH = 4  # texels or edges to each side
WIDER = 3
FACING = 0.5  # least cosine between normals of neighbours
FAR = 3.0  # a neighbour may be so many times as far away as its distance in texels says
MOST_EDGES, NEXT, NEAR = 12, 20, 80  # neighbours of a vertex: along edges, within two edges, within four
RIDGE = 1e-3  # keeps a regression stable where a guide is constant


class Window:
    """The weighted neighbours of each point, up to 81.

    `numbers`: of the neighbours, int32 (neighbours, points), below 0 where there is none on the same part of the
    surface; `weights`, (neighbours, points), and `places` along two tangents, relative to the window's size,
    (neighbours, points, 2), or both without the axis of the points if they are the same for all."""

    def __init__(self, numbers: np.ndarray, weights: np.ndarray, places: np.ndarray, pool: _core.ThreadPool):
        arrays = (np.ascontiguousarray(part, np.float32) for part in (weights, places))
        self._window, self._pool = _core.Window(np.ascontiguousarray(numbers), *arrays), pool
        self.numbers, self.weights = numbers, weights

    def mean(self, values: np.ndarray) -> np.ndarray:
        """The weighted mean over each window of values (points, ...)."""
        return self._window.mean(_rows(values), self._pool).reshape(values.shape)

    def regression(self, guides: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A linear regression in each window explains the values (points, ...) by the place and the guides (points, n).
        (The fit at each point, the share of the point's own value in its fit)."""
        fit, leverage = self._window.regression(_rows(guides), _rows(values), RIDGE, self._pool)
        return fit.reshape(values.shape), leverage


def _rows(values: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(values.reshape(len(values), -1), float)


def windows(places: Places, pool: _core.ThreadPool) -> Texels | Vertices:
    """The windows of the points of an image, or of vertices: `narrow()` and `wide()`."""
    return Texels(places, pool) if places.is_image else Vertices(places, pool)


class Texels:
    """`number` of each texel, with a margin; the texels' `rows` and `columns` there; their `size` in mm."""

    def __init__(self, places: Places, pool: _core.ThreadPool):
        self._pool, margin, mask = pool, REACH * WIDER, places.mask
        self.number = np.full(tuple(side + 2 * margin for side in mask.shape), -1, np.int32)
        self.number[margin:-margin, margin:-margin][mask] = np.arange(int(mask.sum()))
        self.rows, self.columns = (index + margin for index in np.nonzero(mask))
        self.positions, self.normals = places.points.positions, places.points.normals
        self.size = self._size()

    def narrow(self) -> Window:
        return self._window(1)

    def wide(self) -> Window:
        return self._window(WIDER)

    def _window(self, step: int) -> Window:
        """The window of texels whose distances along rows and columns are multiples of `step`."""
        offsets = np.array([(x, y) for y in range(-REACH, REACH + 1) for x in range(-REACH, REACH + 1)])
        away = np.hypot(*offsets.T)
        numbers = np.empty((len(offsets), len(self.rows)), np.int32)
        lengths = np.linalg.norm(self.normals, axis=1)
        for found, (x, y), far in zip(numbers, step * offsets, step * away, strict=True):
            other, distance = self._at(y, x)
            facing = np.einsum("ij,ij->i", self.normals[other], self.normals)
            near = (distance <= FAR * far * self.size) & (facing >= FACING * lengths)
            found[:] = np.where(near, other, -1)
        return Window(numbers, np.exp(-0.5 * (away / (0.5 * REACH)) ** 2), offsets / REACH, self._pool)

    def _at(self, y: int, x: int) -> tuple[np.ndarray, np.ndarray]:
        """(number of the texel at this offset from each, or -1; its distance in mm)."""
        other = self.number[self.rows + y, self.columns + x]
        return other, np.linalg.norm(self.positions[other] - self.positions, axis=1)

    def _size(self) -> np.ndarray:
        """The larger of the distances in mm to the next texels to the right and above, or the median where none is."""
        steps = np.zeros((2, len(self.rows)))
        for axis, (y, x) in enumerate(((0, 1), (1, 0))):
            for sign in (1, -1):
                other, away = self._at(sign * y, sign * x)
                steps[axis] = np.where((other >= 0) & (steps[axis] == 0.0), away, steps[axis])
        usual = np.median(steps[steps > 0.0]) if (steps > 0.0).any() else 0.0
        steps = np.where(steps > 0.0, steps, usual)
        return np.minimum(steps.max(axis=0), FAR * usual)


class Vertices:
    """`near`: numbers of the 80 nearest vertices within four edges, (vertices, 80). The first is the vertex itself, and
    so are those that are missing where there are fewer. `edge`: mean length of the edges of each vertex, in mm."""

    def __init__(self, places: Places, pool: _core.ThreadPool):
        self._pool, self.positions, self.normals = pool, places.points.positions, places.points.normals
        count = len(self.positions)
        number = np.full(len(places.mask), -1, np.int32)
        number[places.mask] = np.arange(count)
        pairs = number[places.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)]
        pairs = pairs[(pairs >= 0).all(axis=1)]
        pairs = np.unique(np.concatenate([pairs, pairs[:, ::-1]]), axis=0)
        rank = np.arange(len(pairs)) - np.searchsorted(pairs[:, 0], pairs[:, 0])
        pairs, rank = pairs[rank < MOST_EDGES], rank[rank < MOST_EDGES]
        along = np.tile(np.arange(count, dtype=np.int32)[:, None], MOST_EDGES)
        along[pairs[:, 0], rank] = pairs[:, 1]
        lengths = np.linalg.norm(self.positions[along] - self.positions[:, None], axis=2)
        self.edge = lengths.sum(axis=1) / np.maximum((lengths > 0.0).sum(axis=1), 1)
        self.near, places_in_mm = along, np.ascontiguousarray(self.positions, float)
        for most in (NEXT, NEAR):
            self.near = _core.nearest_vertices(places_in_mm, self.near, most, pool)

    def narrow(self) -> Window:
        return self._window(self.near, REACH)

    def wide(self) -> Window:
        return self._window(self._far(), WIDER * REACH)

    def _far(self) -> np.ndarray:
        """Numbers of 80 vertices, most of them within twelve edges: random walks over `near`, the same ones everywhere.
        """
        columns = np.random.default_rng(0).integers(NEAR, size=(WIDER**2, NEAR))
        columns[:, 0] = 0  # the vertex itself
        found = np.tile(np.arange(len(self.near), dtype=np.int32)[:, None], NEAR)
        for step in columns:
            found = self.near[found, step]
        return found

    def _window(self, members: np.ndarray, edges: int) -> Window:
        """The window of these members (vertices, n) that reaches so many edges."""
        numbers = np.ascontiguousarray(members.T)
        size = edges * np.maximum(self.edge, 1e-30)[:, None]
        tangents, itself = frames_about(self.normals)[:, :2], np.arange(len(members))
        weights, places = (np.empty((*numbers.shape, *last), np.float32) for last in ((), (2,)))
        for k, other in enumerate(numbers):
            apart = (self.positions[other] - self.positions) / size
            facing = np.einsum("ij,ij->i", self.normals[other], self.normals)
            square = np.einsum("ij,ij->i", apart, apart)
            found = ((facing >= FACING) & (square <= 1.0) & (other != itself)) | (k == 0)
            weights[k] = found * np.exp(-2.0 * square)
            places[k] = np.einsum("nij,nj->ni", tangents, apart)
        return Window(numbers, weights, places, self._pool)
