# SPDX-License-Identifier: GPL-3.0-or-later
"""Photons in a sphere of extinction 1, scattered by Henyey and Greenstein's phase function and never absorbed."""

import math

import numpy as np
from half_space_photons import turned, turned_cosine


def exits(radius, g, number, count, rng):
    """Follow `number` photons that enter the pole (0, 0, radius) downwards, for up to `count` scatterings.

    Yields, after 0, 1, ... scatterings, (places, directions) of the photons that leave, each of shape (n, 3)."""
    place, way = np.tile([0.0, 0.0, radius], (number, 1)), np.tile([0.0, 0.0, -1.0], (number, 1))
    for _ in range(count + 1):
        along = np.sum(place * way, axis=1)
        # The distance to the surface; the first term loses digits where the photon is near the surface.
        depth = np.maximum((radius - np.linalg.norm(place, axis=1)) * (radius + np.linalg.norm(place, axis=1)), 0.0)
        root = np.sqrt(along**2 + depth)
        most = np.where(along > 0.0, depth / np.maximum(along + root, 1e-300), root - along)
        flight = rng.exponential(size=len(place))
        leaves = flight >= most
        yield place[leaves] + way[leaves] * most[leaves, None], way[leaves]
        place, way = (place + way * flight[:, None])[~leaves], way[~leaves]
        way = turned(way, turned_cosine(g, rng.random(len(way))), 2.0 * math.pi * rng.random(len(way)))
