# SPDX-License-Identifier: GPL-3.0-or-later
"""Reduces the noise of a map without blurring veins.

1. In a window around each texel, a linear regression (weighted by distance) explains the values by the place in the
   image and by guides: how strongly the interior absorbs below the texel, at several depths. Guides have no noise.
2. Local Wiener filter (Lee 1980): the residual of the regression is multiplied by S / (S + N), where N is the variance
   of the noise, known from the walks, and S the rest of the residual's mean square in the window. Where the regression
   explains all but noise, its value remains; where it misses a detail, such as the edge of a shadow, the value of the
   walks remains. With few noise the filter changes little."""

from __future__ import annotations

import numpy as np

from ..interior.grid import Interior
from ..walks.searchlight_moments import Measured
from .places import Places, frames_about

REACH = 4  # texels: windows are 9 texels wide
DEPTHS = (0.5, 2.0, 6.0)  # of the guides, in transport mean free paths
RIDGE = 1e-3  # keeps the regression stable where a guide is constant
FACING = 0.5  # least cosine between normals of neighbours
FAR = 3.0  # a neighbour may be so many times as far away as its distance in texels says


def smoothed(places: Places, interior: Interior, measured: Measured) -> Measured:
    """Values of less noise at the points of a map over an image, with approximate standard errors, (points, ...). The
    last axis has three channels, and further numbers with a filter of their own. `measured`: values and standard
    errors. Values of vertices are returned as they are."""
    if not places.is_image:
        return measured
    shape = measured.value.shape
    values = np.nan_to_num(measured.value.reshape(len(measured.value), int(np.prod(shape[1:]))))
    variances = np.nan_to_num(measured.stderr.reshape(values.shape)) ** 2
    window = _Window(places)
    fit, leverage = _regression(window, _guides(places, interior), values)
    residual = values - fit
    noise = window.mean(variances).reshape(shape)
    rest = window.mean(residual**2 - (1.0 - leverage[:, None]) * variances).reshape(shape)
    share = np.ones(shape)
    # All channels share one factor, so that the filter adds no colour.
    for part in (slice(3), slice(3, None)) if shape[-1] > 3 else (slice(3),):
        left = np.maximum(rest[..., part].mean(axis=-1, keepdims=True), 0.0)
        total = left + noise[..., part].mean(axis=-1, keepdims=True)
        share[..., part] = np.divide(left, total, out=np.ones_like(total), where=total > 0.0)
    own = leverage.reshape(-1, *(1,) * (len(shape) - 1))
    kept = np.sqrt(own + share**2 * (1.0 - own))  # of the noise
    return Measured(fit.reshape(shape) + share * residual.reshape(shape), kept * np.sqrt(variances).reshape(shape))


class _Window:
    """The neighbours of each texel, offset by offset."""

    def __init__(self, places: Places):
        mask = places.mask
        self._number = np.full(tuple(side + 2 * REACH for side in mask.shape), -1)
        self._number[REACH:-REACH, REACH:-REACH][mask] = np.arange(int(mask.sum()))
        self._rows, self._columns = (index + REACH for index in np.nonzero(mask))
        self._positions, self._normals = places.points.positions, places.points.normals
        self._texel = self._texel_size()
        self.offsets = [(y, x) for y in range(-REACH, REACH + 1) for x in range(-REACH, REACH + 1)]

    def neighbours(self, y: int, x: int) -> tuple[np.ndarray, np.ndarray]:
        """(number of the neighbour of each texel, or 0; its weight, 0 where there is none on the same part of the
        surface)."""
        other = self._number[self._rows + y, self._columns + x]
        found, away = other >= 0, float(np.hypot(y, x))
        other = np.where(found, other, 0)
        distance = np.linalg.norm(self._positions[other] - self._positions, axis=1)
        facing = np.einsum("ij,ij->i", self._normals[other], self._normals)
        found &= (distance <= FAR * away * self._texel) & (facing >= FACING * np.linalg.norm(self._normals, axis=1))
        return other, found * np.exp(-0.5 * (away / (0.5 * REACH)) ** 2)

    def mean(self, values: np.ndarray) -> np.ndarray:
        """The weighted mean over each window of values (points, n)."""
        total, weights = np.zeros_like(values), np.zeros((len(values), 1))
        for y, x in self.offsets:
            other, weight = self.neighbours(y, x)
            total += weight[:, None] * values[other]
            weights += weight[:, None]
        return total / weights

    def _texel_size(self) -> np.ndarray:
        """The larger of the distances in mm to the next texels to the right and above, or the median where none is."""
        steps = np.zeros((2, len(self._rows)))
        for axis, (y, x) in enumerate(((0, 1), (1, 0))):
            for sign in (1, -1):
                other = self._number[self._rows + sign * y, self._columns + sign * x]
                away = np.linalg.norm(self._positions[other] - self._positions, axis=1)
                steps[axis] = np.where((other >= 0) & (steps[axis] == 0.0), away, steps[axis])
        usual = np.median(steps[steps > 0.0]) if (steps > 0.0).any() else 0.0
        steps = np.where(steps > 0.0, steps, usual)
        return np.minimum(steps.max(axis=0), FAR * usual)


def _guides(places: Places, interior: Interior) -> np.ndarray:
    """(points, depths): the mean over channels of sqrt(sigma_a / (sigma_a + sigma_s (1 - g))), on which the albedo of a
    deep medium depends almost linearly, averaged over five points at each depth; scaled to a variance of 1."""
    positions, normals = places.points.positions, places.points.normals
    g = _mean_g(interior)
    scatterings, absorptions = interior.at(positions)
    path = float(np.median(1.0 / np.maximum(scatterings * (1.0 - g) + absorptions, 1e-9)))
    first, second, _ = frames_about(normals).swapaxes(0, 1)
    found = []
    for depth in DEPTHS:
        total = np.zeros(len(positions))
        for across in (0.0 * first, first, -first, second, -second):
            sigma_s, sigma_a = interior.at(positions + depth * path * (across - normals))
            reduced = np.maximum(sigma_a + sigma_s * (1.0 - g), 1e-30)
            total += np.sqrt(sigma_a / reduced).mean(axis=1)
        found.append(total)
    guides = np.column_stack(found)
    return (guides - guides.mean(axis=0)) / np.maximum(guides.std(axis=0), 1e-9 + 1e-6 * np.abs(guides).max())


def _mean_g(interior: Interior) -> float:
    return float(np.mean([one.g for one in interior.palette])) if interior.palette else interior.g


def _regression(window: _Window, guides: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(the fit at each texel, the share of the texel's own value in its fit)."""
    count, terms = len(guides), 3 + guides.shape[1]
    matrix, right = np.zeros((count, terms, terms)), np.zeros((count, terms, values.shape[1]))
    row = np.empty((count, terms))
    for y, x in window.offsets:
        other, weight = window.neighbours(y, x)
        row[:, 0], row[:, 1], row[:, 2] = 1.0, x / REACH, y / REACH
        row[:, 3:] = guides[other] - guides
        weighted = weight[:, None] * row
        matrix += weighted[:, :, None] * row[:, None, :]
        right += weighted[:, :, None] * values[other][:, None, :]
    ridge = RIDGE * matrix[:, 0, 0]
    for term in range(1, terms):
        matrix[:, term, term] += ridge
    inverse = np.linalg.inv(matrix)[:, 0]  # the fit at the texel is the constant term
    return np.einsum("nt,ntc->nc", inverse, right), inverse[:, 0]
