# SPDX-License-Identifier: GPL-3.0-or-later
"""Sources below a plane, in an absorbing medium, whose light reproduces a profile.

In a diffusing medium with the decay k, a source at the depth z under an absorbing plane sends to the distance r on the
plane the flux density z (1 + k t) exp(-k t) / (2 pi t^3), where t^2 = r^2 + z^2. Here each source is scaled by
exp(k z), so that one unit of flux reaches the plane. A profile is a mixture of such sources. The mixture tells how
light depends on the length of its way, which a curved surface changes."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from . import plane_rings

# The decay is read from the profile between the distances within which these shares of the flux leave. Beyond lies
# too little light for an exact slope; nearer, the depths of the sources change the slope.
TAIL = (0.997, 0.9993)
PLACES, STEPS, COARSE = 80, 400, 4  # depths of the mixture, steps of the iteration, nodes r per bin of the iteration


class Sources(NamedTuple):
    """`depths`, shape (count,): equally likely depths, ascending. `shares`, (count, channels): weight of a source at
    that depth, with a mean of 1 over depths. `decay`, (channels,): k of the medium, one over the unit of depth."""

    depths: np.ndarray
    shares: np.ndarray
    decay: np.ndarray


def flux_density(depths: np.ndarray, r: np.ndarray, decay: float) -> np.ndarray:
    """Flux density at the distances `r` from sources at `depths`, each of unit flux, shape (len(r), len(depths))."""
    way = np.hypot(depths, r[:, None])
    return depths / (2.0 * math.pi * way**3) * (1.0 + decay * way) * np.exp(-decay * (way - depths))


def exit_cosines(sources: Sources, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Cosines, shape (count,), at which light from the sources hits the plane, and the share of the light at each,
    shape (count, channels). The part x exp(-k z (1 / x - 1)) of a source's light arrives flatter than at the cosine
    x = z / t."""
    edges = np.linspace(0.0, 1.0, count + 1)[1:]
    shares = np.empty((count, len(sources.decay)))
    for c, (k, of_depth) in enumerate(zip(sources.decay, sources.shares.T, strict=True)):
        flatter = edges * np.exp(-k * sources.depths[:, None] * (1.0 / edges - 1.0))
        shares[:, c] = of_depth @ np.diff(flatter, axis=1, prepend=0.0)
    return edges - 0.5 / count, shares / shares.sum(axis=0)


def fit(r: np.ndarray, light: np.ndarray, count: int) -> Sources:
    """`count` sources for the flux density `light`, shape (len(r), channels), at nodes `r` of plane_rings.distances."""
    channels = light.shape[1]
    flux = plane_rings.within(r, light)
    decay = np.array([_decay(r, light[:, c], flux[:, c]) for c in range(channels)])
    total = np.maximum(flux[-1], plane_rings.LEAST_FLUX)
    half = np.interp(0.5, (flux / total).mean(axis=1), r)
    places = half * np.geomspace(0.002, 20.0, PLACES)
    found = np.stack([_mixture(r, light[:, c], decay[c], places) for c in range(channels)], axis=1)
    mean = found.mean(axis=1)
    # The mixture's weight at a place spreads evenly over the logarithms of depth around the place.
    edges = np.geomspace(places[0] / math.sqrt(places[1] / places[0]),
                         places[-1] * math.sqrt(places[1] / places[0]), PLACES + 1)
    rank = np.concatenate([[0.0], np.cumsum(mean)])
    wanted = (np.arange(count) + 0.5) / count
    depths = np.exp(np.interp(wanted, rank / rank[-1], np.log(edges)))
    cell = np.clip(np.searchsorted(edges, depths) - 1, 0, PLACES - 1)
    shares = found[cell] / mean[cell, None]
    return Sources(depths, shares / shares.mean(axis=0), decay)


def _decay(r: np.ndarray, light: np.ndarray, flux: np.ndarray) -> float:
    """k of the function (1 + k r) exp(-k r) / r^3 with the mean logarithmic slope of the profile's tail."""
    if not flux[-1] > 0.0:
        return 0.0
    first, last = (int(np.searchsorted(flux / flux[-1], share)) for share in TAIL)
    last = min(last, len(r) - 1)
    if last <= first or not light[last] > 0.0:
        return 0.0
    steeper = math.log(light[first] / light[last] * (r[first] / r[last]) ** 3) / (r[last] - r[first])
    middle = math.sqrt(r[first] * r[last])
    # The slope beyond that of 1 / r^3 is k^2 r / (1 + k r).
    return 0.5 * (steeper + math.sqrt(steeper * (steeper + 4.0 / middle))) if steeper > 0.0 else 0.0


def _mixture(r: np.ndarray, light: np.ndarray, decay: float, places: np.ndarray) -> np.ndarray:
    """Non-negative weights, with the sum 1, of sources at the depths `places`: the most likely mixture of which the
    profile is a sample, by expectation maximisation (Richardson 1972, Lucy 1974)."""
    area = plane_rings.areas(r)
    wanted = (light * area).reshape(-1, COARSE).sum(axis=1)
    shown = (flux_density(places, r, decay) * area[:, None]).reshape(-1, COARSE, PLACES).sum(axis=1)
    weights = np.full(PLACES, 1.0 / PLACES)
    if not wanted.sum() > 0.0:
        return weights
    wanted = wanted / wanted.sum()
    for _ in range(STEPS):
        weights = weights * (shown.T @ (wanted / np.maximum(shown @ weights, plane_rings.LEAST_FLUX)))
        weights /= weights.sum()
    return weights
