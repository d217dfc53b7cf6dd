# SPDX-License-Identifier: GPL-3.0-or-later
"""Values with standard errors from the sums that walks of a searchlight keep."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..common.by_content import ByContent

# Relative to the mean square: a smaller variance is rounding.
ROUNDING = 1e-13
WEIGHT, DISTANCE, SQUARE, FIRST_FREQUENCY = 0, 1, 2, 3  # indices in the vector of scores


@dataclass(frozen=True, eq=False)
class Measured(ByContent):
    """Values and their standard errors, arrays of one shape."""

    value: np.ndarray
    stderr: np.ndarray


@dataclass(frozen=True, eq=False)
class SideMoments(ByContent):
    """Estimates for the light that leaves on one side, in one channel: the flux within each radius, and the vector of
    scores (flux, its first and second moment in r, its transform at each q), with their covariance."""

    inside: np.ndarray
    inside_error: np.ndarray
    mean: np.ndarray
    covariance: np.ndarray

    @classmethod
    def of(cls, sides: list, samples: int) -> SideMoments:
        """From one side's sums (within, within_squares, moments, products) of every chunk, in any order: the sums are
        exact before they are rounded."""
        within, within_squares, moments, products = ([math.fsum(column) for column in zip(*sums, strict=True)]
                                                     for sums in zip(*sides, strict=True))
        inside = np.cumsum(within) / samples
        mean = np.array(moments) / samples
        second = np.zeros((mean.size, mean.size))
        second[np.triu_indices(mean.size)] = products
        second = (second + np.triu(second, 1).T) / samples
        covariance = (second - np.outer(mean, mean)) / (samples - 1)
        still = np.diag(covariance) * (samples - 1) <= ROUNDING * np.diag(second)
        covariance[still, :] = covariance[:, still] = 0.0
        return cls(inside, _error(np.cumsum(within_squares) / samples, inside, samples), mean, covariance)

    @property
    def error(self) -> np.ndarray:
        return np.sqrt(np.diag(self.covariance))

    def mean_power(self, power: int) -> tuple[np.float64, np.float64]:
        """The mean of r^power over the light, and its standard error; NaN if no light leaves."""
        flux, moment = self.mean[WEIGHT], self.mean[power]
        if flux == 0.0:
            return np.float64(math.nan), np.float64(math.nan)
        ratio = moment / flux
        slope = np.array([-ratio, 1.0]) / flux
        here = self.covariance[np.ix_([WEIGHT, power], [WEIGHT, power])]
        return ratio, np.sqrt(max(0.0, slope @ here @ slope))


def _error(square: np.ndarray, mean: np.ndarray, samples: int) -> np.ndarray:
    """Standard errors from mean squares and means."""
    variance = square - mean * mean
    return np.sqrt(np.where(variance > ROUNDING * square, variance, 0.0) / (samples - 1))
