# SPDX-License-Identifier: GPL-3.0-or-later
"""Photons in a half-space of extinction 1, scattered by Henyey and Greenstein's phase function and never absorbed."""

import math

import numpy as np


def turned_cosine(g, u):
    """Cosine of the angle of scattering, from uniform random numbers."""
    return 2.0 * u - 1.0 if g == 0.0 else (1.0 + g * g - ((1.0 - g * g) / (1.0 - g + 2.0 * g * u)) ** 2) / (2.0 * g)


def flights(mu, g, number, count, rng):
    """Follow `number` photons that enter at the cosine `mu`, for `count` + 1 flights.

    Yields, after each flight, (indices and distances from the entry of the photons that leave; indices, places and
    directions of those that collide). Places have the shape (n, 3), with the depth last. Directions are those before
    the scattering."""
    place, way = np.zeros((number, 3)), np.tile([math.sqrt(1.0 - mu * mu), 0.0, mu], (number, 1))
    within = np.arange(number)
    for _ in range(count + 1):
        place = place + way * rng.exponential(size=(len(within), 1))
        leaves = place[:, 2] < 0.0
        out = place[leaves] - way[leaves] * place[leaves, 2:] / way[leaves, 2:]
        left, within, place, way = within[leaves], within[~leaves], place[~leaves], way[~leaves]
        yield left, np.hypot(out[:, 0], out[:, 1]), within, place, way
        cosine = turned_cosine(g, rng.random(len(within)))
        way = turned(way, cosine, 2.0 * math.pi * rng.random(len(within)))


def turned(way, cosine, azimuth):
    """Directions at these angles to `way`."""
    aside = np.where(np.abs(way[:, :1]) < 0.9, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    first = np.cross(way, aside)
    first /= np.linalg.norm(first, axis=1)[:, None]
    second, sine = np.cross(way, first), np.sqrt(1.0 - cosine**2)
    aside = first * np.cos(azimuth)[:, None] + second * np.sin(azimuth)[:, None]
    found = way * cosine[:, None] + aside * sine[:, None]
    return found / np.linalg.norm(found, axis=1)[:, None]
