# SPDX-License-Identifier: GPL-3.0-or-later
"""The difference of two sets of pictures of one scene, without the share of their noise."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Difference:
    """All values are relative to the truth's mean over the region and over R, G and B."""

    mean: float  # of the difference
    mean_error: float  # its standard error
    rms: float  # of pixels, without the share of the noise; 0 if noise alone explains the difference
    square: float  # of that rms, which noise can make negative
    square_error: float  # standard error of `square`
    rms_with_noise: float


def difference(truth, other, region):
    """Difference of pictures `other` and `truth`, each (seeds, height, width, 3), over `region` (height, width).

    Pictures of one set differ only in their seeds; two or more seeds, or one picture without noise. The mean square
    difference of the means exceeds the true one by the variances of both means, which the seeds estimate; `square` has
    them subtracted. Standard errors are those of the jackknife over the seeds.
    """
    truth, other = truth[:, region], other[:, region]
    scale = truth.mean()
    mean, square, noisy = _values(truth, other)
    parts = [[_values(np.delete(truth, k, axis=0), other) for k in range(len(truth))]] if len(truth) > 2 else []
    if len(other) > 2:
        parts.append([_values(truth, np.delete(other, k, axis=0)) for k in range(len(other))])
    errors = np.sqrt(sum((len(part) - 1) * np.var(part, axis=0) for part in map(np.array, parts)))
    mean_error, square_error = errors[:2] if parts else (np.nan, np.nan)
    return Difference(float(mean / scale), float(mean_error / scale), float(np.sqrt(max(square, 0.0)) / scale),
                      float(square / scale**2), float(square_error / scale**2), float(np.sqrt(noisy) / scale))


def noise(pictures, region):
    """Standard deviation of a pixel of the mean picture, rms, relative to the mean."""
    pictures = pictures[:, region]
    return float(np.sqrt(_variance(pictures)) / pictures.mean())


def _values(truth, other):
    """(mean difference, mean square without the noise, mean square)."""
    apart = other.mean(axis=0) - truth.mean(axis=0)
    noisy = np.mean(apart**2)
    return apart.mean(), noisy - _variance(truth) - _variance(other), noisy


def _variance(pictures):
    """Variance of the mean picture's pixels, averaged over pixels; 0 for a picture without noise."""
    return pictures.var(axis=0, ddof=1).mean() / len(pictures) if len(pictures) > 1 else 0.0
