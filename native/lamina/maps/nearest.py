# SPDX-License-Identifier: GPL-3.0-or-later
"""Interpolation between scattered places."""

from __future__ import annotations

import numpy as np

BLOCK = 1 << 10  # positions at a time, to limit memory


def nearest(places: np.ndarray, positions: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """(indices, weights), (positions, count), of the nearest of the `places`, which may have any number of coordinates.
    A weight falls with the squared distance."""
    squares = sum((positions[:, axis, None] - places[:, axis]) ** 2 for axis in range(places.shape[1]))
    count = min(count, len(places))
    near = np.argpartition(squares, count - 1, axis=1)[:, :count]
    near.sort(axis=1)
    away = np.take_along_axis(squares, near, axis=1)
    weights = 1.0 / (away + away.mean(axis=1, keepdims=True) + 1e-30)
    return near, weights / weights.sum(axis=1, keepdims=True)
