# SPDX-License-Identifier: GPL-3.0-or-later
"""Reduces the noise of a map without blurring veins.

1. A point is dimmed in a channel if it is much brighter there than its neighbours, by no more than its noise explains.
   The light that is taken away is spread over a wide window.
2. In a window around each point, a linear regression (weighted by distance) explains the values by the place on the
   surface and by guides: how strongly the interior absorbs below the point, at several depths. Guides have no noise.
3. Local Wiener filter (Lee 1980): the residual of the regression is multiplied by S / (S + N), where N is the variance
   of the noise, known from the walks, and S the rest of the residual's mean square in the window. Where the regression
   explains all but noise, its value remains; where it misses a detail, such as the edge of a shadow, the value of the
   walks remains. With few noise the filter changes little.
4. Each channel has walks of its own, so the noise is coloured. The colour of scattered light changes slowly along the
   surface: its regression and its filter have wide windows."""

from __future__ import annotations

import numpy as np

from ..interior.grid import Interior
from ..solver.core_calls import thread_pool
from ..walks.searchlight_moments import Measured
from .places import Places, frames_about
from .windows import Window, windows

DEPTHS = (0.5, 2.0, 6.0)  # of the guides, in transport mean free paths
BRIGHT = 2.5  # times the typical light of the neighbours: brighter points may be dimmed
LEAST_NOISE = 1e-6  # of a channel's variance, relative to the largest
CERTAIN = 3.0  # standard errors that noise may explain
SPREAD = 6  # means over wide windows, one after another


def smoothed(places: Places, interior: Interior, measured: Measured, is_light: bool, threads: int = 0) -> Measured:
    """Values of less noise at the points of a map, with approximate standard errors, (points, ...). The last axis has
    three channels, and further numbers with a filter of their own. `measured`: values and standard errors. `is_light`:
    the values are radiance, and all steps are taken. Otherwise steps 1 and 4 are left out: Relightable needs an albedo
    near 1 as precisely as the walks of its channel give the albedo. `threads`: 0 for all hardware threads."""
    shape = measured.value.shape
    values = np.nan_to_num(measured.value.reshape(shape[0], -1, shape[-1]))
    variances = np.nan_to_num(measured.stderr.reshape(values.shape)) ** 2
    makes = windows(places, thread_pool(threads))
    narrow, guides = makes.narrow(), _guides(places, interior)
    if is_light:
        wide = makes.wide()
        values, variances = _without_outliers(narrow, wide, values, variances)
    fit, leverage = narrow.regression(guides, values)
    own = leverage[:, None, None]
    residual = values - fit
    noise = narrow.mean(variances)
    rest = narrow.mean(residual**2 - (1.0 - own) * variances)
    share = np.ones(values.shape)
    # All channels share one factor, so that the filter adds no colour.
    for part in (slice(3), slice(3, None)) if shape[-1] > 3 else (slice(3),):
        share[..., part] = _share(rest[..., part], noise[..., part])
    kept = own + share**2 * (1.0 - own)  # of the noise's variance
    found = fit + share * residual
    if is_light:
        found[..., :3] = _coloured(wide, guides, (values[..., :3], variances[..., :3]), found[..., :3], kept[..., :3])
    return Measured(found.reshape(shape), np.sqrt(kept * variances).reshape(shape))


def _without_outliers(narrow: Window, wide: Window, values: np.ndarray, variances: np.ndarray):
    """(values, variances) after step 1, channel by channel. Further numbers are dimmed like the mean of channels."""
    light = was = np.maximum(values[..., :3], 0.0)
    certain = was - CERTAIN * np.sqrt(variances[..., :3])
    bright = np.zeros(was.shape, bool)
    for _ in range(2):  # a very bright point raises what is typical
        typical = narrow.mean(np.sqrt(light)) ** 2
        bright |= light > BRIGHT * typical
        light = np.where(bright, np.minimum(light, np.maximum(typical, certain)), light)
    factor = np.ones(values.shape)
    np.divide(light, was, out=factor[..., :3], where=was > 0.0)
    factor[..., 3:] = factor[..., :3].mean(axis=-1, keepdims=True)
    dimmed, taken = factor * values, was - light
    for _ in range(SPREAD):
        taken = wide.mean(taken)
    dimmed[..., :3] += taken
    return dimmed, factor**2 * variances


def _coloured(wide: Window, guides: np.ndarray, raw: tuple[np.ndarray, np.ndarray], found: np.ndarray,
              kept: np.ndarray) -> np.ndarray:
    """`found`, the result of step 3 on the light `raw` (values, variances), with the colours of step 4. `kept`: share
    of the noise's variance in `found`.

    With independent noise of variance N in each channel and a known colour c, the best estimate of the brightness is
    sum(c v / N) / sum(c^2 / N), of variance 1 / sum(c^2 / N)."""
    values, variances = raw
    fit = np.maximum(wide.regression(guides, values)[0], 0.0)
    gray = fit.mean(axis=-1, keepdims=True)
    colour = np.divide(fit, gray, out=np.ones_like(fit), where=gray > 0.0)
    noise = wide.mean(variances)
    largest = noise.max(axis=-1, keepdims=True)
    weights = colour / (np.divide(noise, largest, out=np.ones_like(noise), where=largest > 0.0) + LEAST_NOISE)
    precision = (colour * weights).sum(axis=-1, keepdims=True)

    def in_colour(light: np.ndarray) -> np.ndarray:
        return colour * (weights * light).sum(axis=-1, keepdims=True) / precision

    noise = np.maximum(noise - colour**2 * largest / precision, 0.0)  # of values - in_colour(values)
    share = _share(wide.mean((values - in_colour(values)) ** 2) - noise, wide.mean(kept) * noise)
    plain = in_colour(found)
    return np.where(gray > 0.0, plain + share * (found - plain), found)


def _share(rest: np.ndarray, noise: np.ndarray) -> np.ndarray:
    """S / (S + N) of step 3, one number for all channels, (..., 1)."""
    left = np.maximum(rest.mean(axis=-1, keepdims=True), 0.0)
    total = left + noise.mean(axis=-1, keepdims=True)
    return np.divide(left, total, out=np.ones_like(total), where=total > 0.0)


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
