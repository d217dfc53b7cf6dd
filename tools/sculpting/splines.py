# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves through control points, with frames, along which the dragon's limbs are swept."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Curve:
    """Samples of a curve at equal steps; arrays (n, 3), except `along` (n,), its arc length in mm, and `values` (n, k).

    `side`, `up` and `tangent` are orthonormal: side = up x tangent."""

    points: np.ndarray
    tangent: np.ndarray
    up: np.ndarray
    side: np.ndarray
    along: np.ndarray
    values: np.ndarray

    @property
    def length(self):
        return float(self.along[-1])


def curve(points, ups, values=None, step=0.5):
    """The Catmull-Rom spline through `points` (n, 3), sampled at `step` mm.

    ups: (3,) or (n, 3), approximate directions of `up`; values: (n, k), interpolated as smoothly as the points."""
    points = np.asarray(points, float)
    count = len(points)
    ups = np.broadcast_to(np.asarray(ups, float), (count, 3))
    values = np.zeros((count, 1)) if values is None else np.asarray(values, float).reshape(count, -1)
    knots = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1) ** 0.5)])
    data = np.hstack([points, ups, values])
    fine = _catmull_rom(knots, data, np.linspace(0.0, knots[-1], 60 * count))
    along = _arc_length(fine[:, :3])
    even = np.linspace(0.0, along[-1], max(int(round(along[-1] / step)), 2) + 1)
    fine = np.stack([np.interp(even, along, column) for column in fine.T], axis=1)
    tangent = unit(np.gradient(fine[:, :3], axis=0))
    up = fine[:, 3:6]
    up = unit(up - np.sum(up * tangent, axis=1, keepdims=True) * tangent)
    return Curve(fine[:, :3], tangent, up, np.cross(up, tangent), even, fine[:, 6:])


def unit(vectors):
    """`vectors` (..., 3) scaled to length 1; zero vectors are unchanged."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.maximum(length, 1e-12)


def mirrored(points):
    """The `points` (..., 3) mirrored to the other side: y changes its sign."""
    return np.asarray(points, float) * np.array([1.0, -1.0, 1.0])


def smoothstep(low, high, x):
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def _arc_length(points):
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])


def _catmull_rom(knots, data, at):
    """Cubic Hermite interpolation with the slopes of parabolas through three neighbours."""
    gaps = np.diff(knots)[:, None]
    chord = np.diff(data, axis=0) / gaps
    slope = np.empty_like(data)
    slope[1:-1] = (chord[:-1] * gaps[1:] + chord[1:] * gaps[:-1]) / (gaps[:-1] + gaps[1:])
    slope[0], slope[-1] = chord[0], chord[-1]
    k = np.clip(np.searchsorted(knots, at, side="right") - 1, 0, len(knots) - 2)
    gap = gaps[k]
    t = ((at - knots[k]) / gap[:, 0])[:, None]
    return (
        (1 + 2 * t) * (1 - t) ** 2 * data[k] + t * (1 - t) ** 2 * gap * slope[k]
        + t * t * (3 - 2 * t) * data[k + 1] + t * t * (t - 1) * gap * slope[k + 1]
    )
