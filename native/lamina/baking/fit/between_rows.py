# SPDX-License-Identifier: GPL-3.0-or-later
"""Values between those that are known: weights between the thicknesses that were solved, linear or by cubic splines.

A spline is linear in its values, so the albedo of the interpolated mixture is the spline of the albedos, which are
smooth. Weights themselves have kinks, where a closure enters or leaves the mixture. Beside a kink the spline may be
negative: this weight becomes 0, and the other closures of the view lose as much light."""

from __future__ import annotations

import numpy as np

from ...closures.closure_table import column_albedos
from .mixture import Part
from .slices import SolvedRows

LEAST = 4  # values of a cubic


def linear(values: np.ndarray, solved: SolvedRows, axis: int) -> np.ndarray:
    """Values of all rows, interpolated linearly between solved rows; of several roughnesses, each by itself."""
    if values.shape[axis] > len(solved.rows):
        blocks = np.split(values, values.shape[axis] // len(solved.rows), axis)
        return np.concatenate([linear(block, solved, axis) for block in blocks], axis)
    count = len(solved.axis)
    return values if len(solved.rows) >= count else between(values, np.array(solved.rows), count, axis)


def between(values: np.ndarray, known: np.ndarray, count: int, axis: int) -> np.ndarray:
    """Values at 0 ... count - 1 along an axis, linear between those at `known` places, which begin at 0, and constant
    after the last."""
    if len(known) == 1:
        return np.repeat(values, count, axis)
    wanted = np.minimum(np.arange(count), known[-1])
    after = np.clip(np.searchsorted(known, wanted), 1, None)
    share = (wanted - known[after - 1]) / (known[after] - known[after - 1])
    share = share.reshape([-1 if k == axis else 1 for k in range(values.ndim)])
    return (1.0 - share) * values.take(after - 1, axis) + share * values.take(after, axis)


def spread(part: Part, solved: SolvedRows) -> np.ndarray:
    """Weights [side, closure, row, channel, column] of all rows, from those of the solved ones; of several roughnesses,
    each by itself. Needs LEAST solved rows."""
    matrix = _spline(np.array(solved.rows, float), np.arange(len(solved.axis)))
    found = _by_blocks(part.weights, len(solved.rows), matrix)
    if not all(strip.closure for strip in part.strips):
        return np.minimum(np.maximum(found, 0.0), part.weights.max())  # shares, which are no weights of closures
    return _with_albedo(found, column_albedos(tuple(strip.closure for strip in part.strips)).T[None, :, None, None])


def spread_beside_clean(weights: np.ndarray, albedo: np.ndarray, solved: SolvedRows) -> np.ndarray:
    """Weights [side, closure, row, channel, column] of all thicknesses of each azimuth, from those of the solved ones.
    Weights have a kink at row 1, which is solved: splines begin there. `albedo` [side, closure, azimuth, column]: of
    unit weights, which do not depend on the thickness."""
    matrix = np.zeros((len(solved.axis), len(solved.rows)))
    matrix[0, 0] = 1.0
    matrix[1:, 1:] = _spline(np.array(solved.rows[1:], float), np.arange(1, len(solved.axis)))
    found = _by_blocks(weights, len(solved.rows), matrix)
    return _with_albedo(found, np.repeat(albedo, len(solved.axis), axis=2)[:, :, :, None])


def _by_blocks(weights: np.ndarray, count: int, matrix: np.ndarray) -> np.ndarray:
    """The matrix [wanted, known] applied to each block of `count` rows of weights [side, closure, row, ...]."""
    sides, closures, rows, *rest = weights.shape
    blocks = weights.reshape(sides, closures, rows // count, count, *rest)
    return np.einsum("wr,skbr...->skbw...", matrix, blocks).reshape(sides, closures, -1, *rest)


def _with_albedo(found: np.ndarray, albedo: np.ndarray) -> np.ndarray:
    """Weights without their negative parts, with the same sums of weight and albedo."""
    kept = np.maximum(found, 0.0)
    wanted, reached = ((one * albedo).sum(axis=1, keepdims=True) for one in (found, kept))
    return kept * np.where(reached > 0.0, np.maximum(wanted, 0.0) / np.where(reached > 0.0, reached, 1.0), 0.0)


def _spline(known: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """The matrix [wanted, known] of the cubic spline through values at `known`, whose third derivative is continuous
    at the second and the last but one (de Boor's "not a knot")."""
    count, steps = len(known), np.diff(known)
    # Equations for the second derivatives, and their right sides for each value
    system, right = np.zeros((count, count)), np.zeros((count, count))
    for k in range(1, count - 1):
        before, after = steps[k - 1], steps[k]
        system[k, k - 1:k + 2] = before, 2.0 * (before + after), after
        right[k, k - 1:k + 2] = 6.0 / before, -6.0 / before - 6.0 / after, 6.0 / after
    for k, (near, far) in ((0, steps[:2]), (count - 1, steps[:-3:-1])):
        inner = (0, 1, 2) if k == 0 else (k, k - 1, k - 2)
        system[k, list(inner)] = far, -near - far, near
    curved = np.linalg.solve(system, right)
    before = np.clip(np.searchsorted(known, wanted, side="right") - 1, 0, count - 2)
    step, values = steps[before][:, None], np.eye(count)
    high = (wanted - known[before])[:, None] / step
    low = 1.0 - high
    return (low * values[before] + high * values[before + 1]
            + step**2 / 6.0 * ((low**3 - low) * curved[before] + (high**3 - high) * curved[before + 1]))
