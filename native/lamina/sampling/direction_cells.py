# SPDX-License-Identifier: GPL-3.0-or-later
"""Cells of directions of light, finer about the mirror direction of a view, with probabilities."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

THETA_CELLS, AZIMUTH_CELLS = 40, 24  # of theta in [0, pi / 2], and of |dphi| in [0, pi]
NARROW = 0.12  # radians: half of the cells of each axis follow a Cauchy density of this width


@dataclass(frozen=True, eq=False)
class DirectionCells:
    """`mu`: cosines between cells, falling, (THETA_CELLS + 1,); `azimuth`: |dphi| between cells, rising. `share`:
    probabilities [path, theta, azimuth], which add up to 1. In a cell all directions are equally likely."""

    mu: np.ndarray
    azimuth: np.ndarray
    share: np.ndarray

    @classmethod
    def about(cls, mu_o: float, values) -> DirectionCells:
        """Cells for a view. `values(mu_i, dphi)`: for each path what a direction contributes to the light, arrays that
        broadcast."""
        theta = _edges(0.5 * np.pi, np.arccos(mu_o), THETA_CELLS)
        mu, azimuth = np.cos(theta), _edges(np.pi, 0.0, AZIMUTH_CELLS)
        mu[-1] = 0.0
        middle = 0.5 * (mu[1:] + mu[:-1])[:, None], 0.5 * (azimuth[1:] + azimuth[:-1])
        sizes = -np.diff(mu)[:, None] * np.diff(azimuth)
        weights = np.stack([np.maximum(one, 0.0) * sizes for one in values(*middle)])
        if not weights.any():  # without light every direction will do
            weights = np.broadcast_to(sizes, weights.shape)
        return cls(mu, azimuth, weights / weights.sum())

    @functools.cached_property
    def _up_to(self) -> np.ndarray:
        """Sums of the probabilities up to each cell."""
        return np.cumsum(self.share.ravel())

    def density(self, path, mu_i, dphi) -> np.ndarray:
        """Probability per solid angle of directions; `dphi` in [-pi, pi]."""
        row = np.clip(np.searchsorted(-self.mu, -mu_i, side="right") - 1, 0, THETA_CELLS - 1)
        column = np.clip(np.searchsorted(self.azimuth, np.abs(dphi), side="right") - 1, 0, AZIMUTH_CELLS - 1)
        size = 2.0 * (self.mu[row] - self.mu[row + 1]) * (self.azimuth[column + 1] - self.azimuth[column])
        return self.share[path, row, column] / size

    def drawn(self, u) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(path, mu_i, dphi) for uniform numbers u, (n, 3) in [0, 1)."""
        up_to = self._up_to
        cell = np.minimum(np.searchsorted(up_to, u[:, 0] * up_to[-1], side="right"), up_to.size - 1)
        path, row, column = np.unravel_index(cell, self.share.shape)
        mu = self.mu[row] + u[:, 1] * (self.mu[row + 1] - self.mu[row])
        turn = 2.0 * u[:, 2] - 1.0
        size = self.azimuth[column + 1] - self.azimuth[column]
        return path, mu, np.where(turn < 0.0, -1.0, 1.0) * (self.azimuth[column] + np.abs(turn) * size)


def _edges(end: float, middle: float, count: int) -> np.ndarray:
    """Edges between `count` cells of [0, end]: half of the cells are even, half follow a Cauchy density."""
    fine = np.linspace(0.0, end, 4001)
    narrow = np.arctan((fine - middle) / NARROW)
    narrow = (narrow - narrow[0]) / (narrow[-1] - narrow[0])
    return np.interp(np.linspace(0.0, 1.0, count + 1), 0.5 * (narrow + fine / end), fine)
