# SPDX-License-Identifier: GPL-3.0-or-later
"""Two sets of renders of one scene against each other: means, their errors, and the verdict."""

import math
from dataclasses import asdict, dataclass

import numpy as np

SIGMAS = 3.0


@dataclass(frozen=True)
class Comparison:
    """Radiances are means over the region and over R, G, B; errors of the fit are relative."""

    mean_truth: float
    sigma_truth: float  # standard error of mean_truth, from the spread between seeds
    mean_baked: float
    sigma_baked: float
    rms_truth: float
    rms_difference: float  # pixel by pixel, including the noise of both renders
    rms_without_noise: float  # the same without the share of the noise
    noise_truth: float  # standard deviation of a pixel, rms, over mean_truth
    noise_baked: float
    fit_error: float  # mean over the LUT's slices
    worst_slice_error: float
    pixels: int
    geometry_error: float = 0.0  # relative: effect of the truth's own geometry, such as curvature

    @property
    def noise(self):
        """Allowed difference of the means by chance."""
        return SIGMAS * math.hypot(self.sigma_truth, self.sigma_baked)

    @property
    def allowed(self):
        """Allowed difference of the means: by noise, by the error of the fit, and by the truth's geometry."""
        return self.noise + (self.fit_error + self.geometry_error) * self.mean_truth

    @property
    def allowed_rms(self):
        """Allowed rms difference of pixels without noise: the error of the worst slice."""
        return self.noise + (self.worst_slice_error + self.geometry_error) * self.rms_truth

    @property
    def agree(self):
        # NaN must not agree.
        means = abs(self.mean_baked - self.mean_truth) <= self.allowed
        return bool(means and self.rms_without_noise <= self.allowed_rms)

    def facts(self):
        """All fields as plain data."""
        return {**asdict(self), "agree": self.agree, "allowed_difference": self.allowed,
                "allowed_rms": self.allowed_rms}

    def verdict(self, truth="volume"):
        """One sentence with the numbers; `truth`: name of the path-traced body."""
        word = "agree" if self.agree else "DO NOT AGREE"
        mean = self.mean_truth
        geometry = f", geometry {self.geometry_error:.2%}" if self.geometry_error else ""
        return (
            f"{truth} {mean:.5f} and baked {self.mean_baked:.5f} {word}: "
            f"{self.mean_baked / mean - 1.0:+.2%} apart, {self.allowed / mean:.2%} allowed "
            f"(noise {self.noise / mean:.2%}, fit {self.fit_error:.2%}{geometry}); "
            f"pixels {self.rms_without_noise / self.rms_truth:.2%} rms, "
            f"{self.allowed_rms / self.rms_truth:.2%} allowed (worst slice)"
        )


def compare(truth, baked, region, report, geometry_error=0.0):
    """Comparison of renders, each (seeds, height, width, 3), over the pixels of `region` (height, width).

    report: the LUT's, for `fit_error` and `worst_slice`. geometry_error: see Comparison.
    """
    truth, baked = truth[:, region], baked[:, region]
    mean_truth, sigma_truth, variance_truth = _statistics(truth)
    mean_baked, sigma_baked, variance_baked = _statistics(baked)
    square = np.mean((baked.mean(axis=0) - truth.mean(axis=0)) ** 2)
    return Comparison(
        mean_truth=mean_truth,
        sigma_truth=sigma_truth,
        mean_baked=mean_baked,
        sigma_baked=sigma_baked,
        rms_truth=_root(np.mean(truth.mean(axis=0) ** 2) - variance_truth),
        rms_difference=_root(square),
        rms_without_noise=_root(square - variance_truth - variance_baked),
        noise_truth=_root(variance_truth) / mean_truth,
        noise_baked=_root(variance_baked) / mean_truth,
        fit_error=float(report["fit_error"]),
        worst_slice_error=float(report["worst_slice"]["error"]),
        pixels=int(np.count_nonzero(region)),
        geometry_error=float(geometry_error),
    )


def _statistics(samples):
    """(mean, its standard error, mean variance of a pixel's mean) of samples (seeds, pixels, 3).

    The standard error comes from whole renders: pixels of one render share their random sequence.
    """
    seeds = len(samples)
    of_seed = samples.mean(axis=(1, 2))
    return (
        float(of_seed.mean()),
        float(of_seed.std(ddof=1) / math.sqrt(seeds)),
        float(samples.var(axis=0, ddof=1).mean() / seeds),
    )


def _root(square):
    # Differences of noisy estimates may fall below zero; NaN stays.
    return float(np.sqrt(np.maximum(square, 0.0)))
