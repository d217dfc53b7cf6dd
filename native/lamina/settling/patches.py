# SPDX-License-Identifier: GPL-3.0-or-later
"""Patches of dust that was not wiped off, as a smooth random field in space."""

from __future__ import annotations

from statistics import NormalDist

import numpy as np

WAVES = 48
EDGE = 0.15  # share of the area in which a patch fades


def patches(positions: np.ndarray, coverage: float, size: float, seed: int) -> np.ndarray:
    """(n,) float64 in [0, 1]: the share of dust that stays at (n, 3) positions; its mean over space is `coverage`.

    A sum of plane waves of random direction and phase, with wavelengths of about `size`, is nearly normally
    distributed. Its quantile is then uniform in [0, 1], and a ramp of the quantile has exactly the wanted mean."""
    edge = min(EDGE, 2.0 * coverage, 2.0 * (1.0 - coverage))
    if edge <= 0.0:
        return np.full(len(positions), coverage)
    rng = np.random.Generator(np.random.PCG64([seed, 0x70617463]))
    directions = rng.normal(size=(WAVES, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    waves = directions * (2.0 * np.pi / size * rng.uniform(0.35, 1.0, WAVES))[:, None]
    phases = rng.uniform(0.0, 2.0 * np.pi, WAVES)
    quantiles = np.linspace(0.0, 1.0, 1025)[1:-1]
    normal = NormalDist()
    levels = np.array([normal.inv_cdf(q) for q in quantiles])
    left = np.empty(len(positions))
    for first in range(0, len(positions), 1 << 14):
        part = slice(first, first + (1 << 14))
        field = np.cos(positions[part] @ waves.T + phases).sum(axis=1) / np.sqrt(WAVES / 2)
        left[part] = np.clip((coverage - np.interp(field, levels, quantiles)) / edge + 0.5, 0.0, 1.0)
    return left
