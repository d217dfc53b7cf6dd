# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays of a portal, sampled from its tables like by the nodes."""

import math

import numpy as np

COUNT = 400_000


def drawn(tables, seed, radius=math.inf):
    """(distances, weights, sines with the normal where the rays hit) of rays sampled like in the shader: random source
    and cosine, weight by the hit on a plane, or on a sphere of `radius` mm. The view is along the normal."""
    rng = np.random.default_rng(seed)
    source = rng.integers(0, len(tables.depths), COUNT)
    z = tables.depths[source]
    lifted = np.sqrt(tables.lift**2 + (1.0 + 2.0 * tables.lift) * rng.random(COUNT))
    cosine = lifted - tables.lift
    sine = np.sqrt(np.maximum(1.0 - cosine**2, 0.0))
    if math.isinf(radius):
        t, h, s = z / cosine, z, np.zeros(COUNT)
    else:
        up = radius - z  # height over the centre
        t = np.sqrt(radius**2 - up**2 * sine**2) - up * cosine
        h = t * (up * cosine + t) / radius
        s = np.clip(z / (2.0 * radius), 0.0, 1.0)
    density = lifted / (0.5 + tables.lift)
    shape = (np.minimum(z / h, 1.0) * (1.0 - s) ** tables.curved)[:, None]
    fall = np.exp(-tables.decay * (t - z)[:, None])
    weights = (shape + tables.decay * t[:, None] * np.sqrt(shape)) * fall * tables.shares[-1, source]
    return t * sine, weights / density[:, None], np.sqrt(np.maximum(1.0 - (h / t) ** 2, 0.0))
