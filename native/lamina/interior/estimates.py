# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimates and standard errors from the sums over walks."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from ..common.by_content import ByContent
from ..walks.searchlight_moments import Measured
from .lamps import AnyLamp

COUNTS = ("mirrored", "lost", "scatterings", "collisions", "rays")
NUMBERS = 11  # by which the core describes light: three channels and eight moments
# Index of the product v_i v_j, i <= j, for v = (w, w r, w r^2).
_PRODUCT = {(0, 0): 0, (0, 1): 1, (0, 2): 2, (1, 1): 3, (1, 2): 4, (2, 2): 5}


@dataclass(frozen=True)
class WalkCount:
    """The cost of the walks. `seconds`: total time, NaN for merged parts. `samples`: samples per point. `lost`: share
    of the light that misses the surface by rounding errors; this light is missing from the results. `collisions`:
    scatterings and rejected collisions. `rays`: number of rays traced. `photons`: of each lamp, 0 where walks from the
    points found the lamps."""

    seconds: float = field(compare=False)
    samples: int
    lost: float
    scatterings: int
    collisions: int
    rays: int
    photons: int = 0


@dataclass(frozen=True, eq=False)
class ExitEstimate(ByContent):
    """The light that leaves a solid, for unit flux that enters at each of n points. Estimates have `value` and `stderr`
    of shape (n, 3): red, green, blue.

    `albedo`: the flux that leaves at any point of the surface, without the boundary's reflection at the point of entry.
    `mirrored`, (n,): the share that the boundary reflects at the point of entry. `mean_distance` (mm) and
    `mean_square_distance` (mm^2): straight distance between entry and exit; NaN where no light leaves. Only the first
    exit counts. With one sample, the standard error of `albedo` is the value, and those of the distances are NaN."""

    albedo: Measured
    mirrored: np.ndarray
    mean_distance: Measured
    mean_square_distance: Measured
    count: WalkCount


@dataclass(frozen=True, eq=False)
class LightEstimate(ByContent):
    """The radiance that leaves a solid at each of n points after transport inside. `lamps`: for each lamp of unit
    strength, shape (n, lamps, 3). `sky`: for the surroundings, by default of radiance 1, shape (n, 3). Both have
    `value` and `stderr`. The boundary's reflection at the point is not included.

    `lamp_moments`, (n, lamps, 8), and `sky_moments`, (n, 8): the mean over channels times x, y, z, x^2, y^2, xy, yz and
    zx of the direction w to the eye, as cosine-weighted means over w; for given directions without a mean. A
    standard error from one sample is the absolute value."""

    lamps: Measured
    sky: Measured
    lamp_moments: Measured
    sky_moments: Measured
    lamps_used: tuple[AnyLamp, ...]
    count: WalkCount


def exit_estimate(moments, products, counts, samples: int, seconds: float) -> ExitEstimate:
    """The estimate from sums: moments [point, channel, (w, w r, w r^2)], products [point, channel, 6]."""
    albedo = _mean(moments[..., 0], products[..., 0], samples)
    return ExitEstimate(albedo, counts[:, 0] / samples, _ratio(moments, products, 1, samples),
                        _ratio(moments, products, 2, samples), walk_count(counts, samples, seconds))


def light_estimate(sums, squares, counts, samples: int, lamps: tuple[AnyLamp, ...], seconds: float) -> LightEstimate:
    """The estimate from sums and sums of squares [point, source, (channels, moments)]. Sources: the lamps, then the
    sky."""
    light, moments = _split(_mean(sums, squares, samples))

    def of(found: Measured, sources: slice | int) -> Measured:
        return Measured(found.value[:, sources], found.stderr[:, sources])

    every = slice(0, -1)
    return LightEstimate(of(light, every), of(light, -1), of(moments, every), of(moments, -1), lamps,
                         walk_count(counts, samples, seconds))


def with_photons(sky: LightEstimate, arrays, photons: int, lamps: tuple[AnyLamp, ...]) -> LightEstimate:
    """The estimate by walks without lamps, or with the part of the light of lamps that photons do not bring, and the
    light of lamps from so many photons each. `arrays`: sums and squares [point, lamp, (channels, moments)], counts
    [lamp, 5]."""
    sums, squares, counts = arrays
    sent = walk_count(counts, photons, math.nan)
    walked = sky.count
    count = WalkCount(walked.seconds, walked.samples, max(walked.lost, sent.lost),
                      walked.scatterings + sent.scatterings, walked.collisions + sent.collisions,
                      walked.rays + sent.rays, photons)
    light, moments = _split(_mean(sums, squares, photons))
    if sky.lamps_used:
        light, moments = _sum(light, sky.lamps), _sum(moments, sky.lamp_moments)
    return replace(sky, lamps=light, lamp_moments=moments, lamps_used=lamps, count=count)


def without_lamps(light: LightEstimate) -> LightEstimate:
    """The light of the surroundings alone."""
    none = Measured(light.lamps.value[:, :0], light.lamps.stderr[:, :0])
    return replace(light, lamps=none, lamp_moments=none, lamps_used=())


def walk_count(counts: np.ndarray, samples: int, seconds: float) -> WalkCount:
    total = dict(zip(COUNTS, counts.sum(axis=0), strict=True))
    return WalkCount(seconds, samples, float(total["lost"]) / (samples * len(counts)),
                     *(int(total[name]) for name in COUNTS[2:]))


def _mean(sums, squares, samples: int) -> Measured:
    """The mean with its standard error. One sample does not show its variance. The square of the sample takes the
    variance's place: on average this is too large, by the square of the mean."""
    if samples == 1:
        return Measured(sums, np.sqrt(squares))
    mean = sums / samples
    return Measured(mean, np.sqrt(np.maximum(squares / samples - mean * mean, 0.0) / (samples - 1)))


def _split(found: Measured) -> tuple[Measured, Measured]:
    """(light by channel, moments)."""
    return (Measured(found.value[..., :3], found.stderr[..., :3]),
            Measured(found.value[..., 3:], found.stderr[..., 3:]))


def _sum(one: Measured, other: Measured) -> Measured:
    return Measured(one.value + other.value, np.hypot(one.stderr, other.stderr))


def _ratio(moments, products, power: int, samples: int) -> Measured:
    """The mean of r**power over the light that leaves, with the standard error of a ratio of means, NaN for one
    sample."""
    mean = moments / samples

    def covariance(i, j):
        return products[..., _PRODUCT[i, j]] / samples - mean[..., i] * mean[..., j]

    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = mean[..., power] / mean[..., 0]
        variance = covariance(power, power) - 2.0 * ratio * covariance(0, power) + ratio**2 * covariance(0, 0)
        return Measured(ratio, np.sqrt(np.maximum(variance, 0.0) / (samples - 1.0)) / mean[..., 0])
