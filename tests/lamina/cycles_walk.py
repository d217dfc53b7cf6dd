# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' random walk in a half-space, photon by photon. It shares nothing with the package.

At most 256 flights. The first ten collisions follow the coefficients of the medium, and nine turns Henyey and
Greenstein's phase function; from the tenth collision on, turns are isotropic and the coefficients those of transport.
The albedo is at least .2, and darker light is scaled. All that reaches the surface leaves."""

from dataclasses import dataclass

import numpy as np
from photon_walk_3d import henyey_greenstein, turned


@dataclass(frozen=True)
class Left:
    """Light that left: the sums over `count` photons of weight and of weight times distance, with standard errors."""

    albedo: float
    albedo_error: float
    moment: float
    moment_error: float


def walk(albedo: float, path: float, g: float, mu_in: float | None, count: int, seed: int) -> Left:
    """For light that enters at the cosine `mu_in`, or with a cosine distribution for None. `path`: mean free path."""
    rng = np.random.default_rng(seed)
    weight = np.full(count, min(1.0, albedo / 0.2))
    albedo = max(albedo, 0.2)
    cosine = np.sqrt(rng.random(count)) if mu_in is None else np.full(count, mu_in)
    place = np.zeros((count, 3))
    way = np.stack([np.sqrt(1.0 - cosine**2), np.zeros(count), cosine], axis=1)  # z down
    light, far = np.zeros(count), np.zeros(count)
    number = np.arange(count)
    for flight in range(256):
        isotropic = flight > 9
        scale = (1.0 - albedo * g if isotropic else 1.0) / path
        step = -np.log1p(-rng.random(len(number))) / scale
        end = place + step[:, None] * way
        out = end[:, 2] < 0.0
        gone = place[out] - way[out] * (place[out, 2] / way[out, 2])[:, None]
        light[number[out]] = weight[out]
        far[number[out]] = np.hypot(gone[:, 0], gone[:, 1])
        weight, place, way, number = weight[~out], end[~out], way[~out], number[~out]
        weight = weight * (albedo * (1.0 - g) / (1.0 - albedo * g) if isotropic else albedo)
        way = turned(way, henyey_greenstein(0.0 if flight >= 9 else g, rng, len(number)), rng)
    moments = light * far
    error = 1.0 / np.sqrt(count)
    return Left(light.mean(), light.std() * error, moments.mean(), moments.std() * error)
