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


@dataclass(frozen=True)
class Estimate:
    """What renders that differ only in the seed say of the mean radiance over a region and over R, G, B."""

    mean: float
    sigma: float  # standard error of the mean, from the spread between seeds
    pixel_variance: float  # of a pixel's mean over the seeds, averaged over the pixels

    @property
    def noise(self):
        """Standard deviation of a pixel, rms, over the mean."""
        return _root(self.pixel_variance) / self.mean


def estimate(samples):
    """The Estimate of samples (seeds, pixels, 3); at least two seeds.

    The standard error comes from whole renders: pixels of one render share their random sequence.
    """
    seeds = len(samples)
    of_seed = samples.mean(axis=(1, 2))
    return Estimate(
        mean=float(of_seed.mean()),
        sigma=float(of_seed.std(ddof=1) / math.sqrt(seeds)),
        pixel_variance=float(samples.var(axis=0, ddof=1).mean() / seeds),
    )


def compare(truth, baked, region, report, geometry_error=0.0):
    """Comparison of renders, each (seeds, height, width, 3), over the pixels of `region` (height, width).

    report: the LUT's, for `fit_error` and `worst_slice`. geometry_error: see Comparison.
    """
    truth, baked = truth[:, region], baked[:, region]
    of_truth, of_baked = estimate(truth), estimate(baked)
    square = np.mean((baked.mean(axis=0) - truth.mean(axis=0)) ** 2)
    return Comparison(
        mean_truth=of_truth.mean,
        sigma_truth=of_truth.sigma,
        mean_baked=of_baked.mean,
        sigma_baked=of_baked.sigma,
        rms_truth=_root(np.mean(truth.mean(axis=0) ** 2) - of_truth.pixel_variance),
        rms_difference=_root(square),
        rms_without_noise=_root(square - of_truth.pixel_variance - of_baked.pixel_variance),
        noise_truth=of_truth.noise,
        noise_baked=_root(of_baked.pixel_variance) / of_truth.mean,
        fit_error=float(report["fit_error"]),
        worst_slice_error=float(report["worst_slice"]["error"]),
        pixels=int(np.count_nonzero(region)),
        geometry_error=float(geometry_error),
    )


def _root(square):
    # Differences of noisy estimates may fall below zero; NaN stays.
    return float(np.sqrt(np.maximum(square, 0.0)))
