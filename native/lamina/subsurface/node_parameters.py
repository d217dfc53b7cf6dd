# SPDX-License-Identifier: GPL-3.0-or-later
"""The conversion of Color and Radius to a medium in Cycles' Subsurface Scattering node, by Blender's version.

From the source of Cycles 4.5 and 5.2: kernel/integrator/subsurface_random_walk.h and kernel/closure/bssrdf.h."""

from __future__ import annotations

import numpy as np

# From this release on, Random Walk uses sigma_t = 1 / Radius and d'Eon's albedo inversion; before, see below.
NEW_WALK = (5, 2)
LEAST_ALBEDO, MOST_ALBEDO = 0.2, 0.999999
LEAST_IOR = 1.01

# Before 5.2: albedo = (1 - b) A atan(B c)^C + b D atan(E c)^F with b = c^(1/4) for the colour c. A, C, D and F are
# polynomials in g, the highest power first; B and E are a + b exp(polynomial).
_A = (7.21067002658, -23.6264803333, 32.0234874259, -22.8215585862, 9.19393289202, -1.79904629312, -1.28451056436,
      1.8260523782)
_B = (4.98511194385, 0.127355959438, (559.009054474, -1935.41424244, 2731.71560286, -2018.09288505, 841.576016723,
                                      -201.847017512, 31.1491581433, 0.0))
_C = (-12.7181042538, 38.5402837518, -46.8802913581, 28.8643230661, -8.83963712726, 1.05258115941, -0.394704063468,
      1.09686102424)
_D = (15.8478295021, -58.5106008578, 82.065982243, -55.2984010333, 17.8896899217, -2.15139309747, 0.360146581622,
      0.496310210422)
_E = (4.23190299701, 0.00310603949088, (1303.5318055, -4763.54467887, 7116.60171912, -5576.68528998, 2448.8834203,
                                        -594.356773233, 76.7316253952, 0.0))
_F = (-87.4370473567, 302.85712436, -403.613804597, 259.082868209, -79.2191708682, 9.18494908356, -2.51814844609,
      2.40602999408)
# Coefficients from 5.2 on: s = _S[0] c - sqrt(_S[1] + _S[2] c + _S[3] c^2) + _S[4].
_S = (4.20863, 9.59217, 41.6808, 17.7126, 4.09712)

_COLOURS = np.linspace(0.0, 1.0, 20001)


def albedo_of_colour(colour, g: float, version: tuple[int, int]) -> np.ndarray:
    """Single-scattering albedo that Cycles' walk uses for a Color in [0, 1], before it is raised to LEAST_ALBEDO."""
    c = np.asarray(colour, float)
    if version >= NEW_WALK:
        s2 = (_S[0] * c - np.sqrt(_S[1] + _S[2] * c + _S[3] * c * c) + _S[4]) ** 2
        return np.clip((1.0 - s2) / (1.0 - g * s2), 0.0, MOST_ALBEDO)
    b, e = (base + factor * np.exp(np.polyval(powers, g)) for base, factor, powers in (_B, _E))
    blend = c**0.25
    dark = np.polyval(_A, g) * np.arctan(b * c) ** np.polyval(_C, g)
    bright = np.polyval(_D, g) * np.arctan(e * c) ** np.polyval(_F, g)
    return np.clip((1.0 - blend) * dark + blend * bright, 0.0, MOST_ALBEDO)


def colour_of_albedo(albedo, g: float, version: tuple[int, int]) -> np.ndarray:
    """The Color that gives a single-scattering albedo, in [0, 1]; the inverse of albedo_of_colour."""
    # The square root spreads the steep start of the old fit over the table.
    places = np.sqrt(np.maximum.accumulate(albedo_of_colour(_COLOURS**2, g, version)))
    return np.interp(np.sqrt(np.asarray(albedo, float)), places, _COLOURS) ** 2


def radius_of_path(mean_free_path, g: float, version: tuple[int, int]) -> np.ndarray:
    """The Radius, in the same unit, of a medium with the mean free path 1 / sigma_t.

    Before 5.2, sigma_t = 4 pi / (Radius (1 - g))."""
    path = np.asarray(mean_free_path, float)
    return path if version >= NEW_WALK else 4.0 * np.pi * path / (1.0 - g)
