# SPDX-License-Identifier: GPL-3.0-or-later
"""Gradient noise with identical results on every machine."""

from __future__ import annotations

import numpy as np

# The directions from the centre of a cube to its edges (Perlin 2002).
_GRADIENTS = np.array([[x, y, 0] for x in (-1, 1) for y in (-1, 1)] + [[x, 0, z] for x in (-1, 1) for z in (-1, 1)]
                      + [[0, y, z] for y in (-1, 1) for z in (-1, 1)], np.float32)
_MULTIPLIERS = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], np.uint64)


def gradient_noise(places: np.ndarray, seed: int) -> np.ndarray:
    """Noise with lattice cells of side 1 at positions of shape (..., 3). Values lie in about [-1, 1] with mean 0. Two
    derivatives are continuous. Perlin, "Improving Noise" (2002); a hash of lattice point and seed selects the
    gradients."""
    cell = np.floor(places)
    within = (places - cell).astype(np.float32)
    fade = within**3 * (within * (within * 6.0 - 15.0) + 10.0)
    keys = [(cell[..., axis].astype(np.int64)[..., None] + np.arange(2)).astype(np.uint64) * _MULTIPLIERS[axis]
            for axis in range(3)]
    total = np.zeros(places.shape[:-1], np.float32)
    for x, y, z in np.ndindex(2, 2, 2):
        key = keys[0][..., x] ^ keys[1][..., y] ^ keys[2][..., z] ^ np.uint64(seed)
        gradient = _GRADIENTS[(_mixed(key) >> np.uint64(40)) % np.uint64(len(_GRADIENTS))]
        weight = np.ones_like(total)
        value = np.zeros_like(total)
        for axis, end in enumerate((x, y, z)):
            weight = weight * (fade[..., axis] if end else 1.0 - fade[..., axis])
            value = value + gradient[..., axis] * (within[..., axis] - end)
        total += weight * value
    return total


def turbulence(places: np.ndarray, octaves: int, lacunarity: float, gain: float, seed: int) -> np.ndarray:
    """Weighted sum of the noise's absolute value over octaves (Perlin 1985). Each octave has `lacunarity` times the
    frequency and `gain` times the weight of the previous octave. The weights sum to 1."""
    total = np.zeros(places.shape[:-1], np.float32)
    weights = gain ** np.arange(octaves)
    for octave, weight in enumerate(weights / weights.sum()):
        total += weight * np.abs(gradient_noise(places * lacunarity**octave, (seed * 64 + octave) % 2**64))
    return total


def _mixed(key: np.ndarray) -> np.ndarray:
    """The 64-bit mixing function of splitmix64."""
    key = (key ^ (key >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    key = (key ^ (key >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return key ^ (key >> np.uint64(31))
