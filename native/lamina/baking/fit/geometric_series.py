# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that a base reflects and the layers throw back, again and again (the geometric series of van de Hulst 1963).

A base of reflectance c adds c A / (1 - c r) to the light over black, where r is the share of the light from the base
that the layers reflect back to it."""

from __future__ import annotations

import numpy as np

LEAST = 1e-12  # a smaller change of the albedo is rounding


def gain(reflectance, thrown_back: np.ndarray) -> np.ndarray:
    """c / (1 - c r), the factor of A; `reflectance` broadcasts to r."""
    return reflectance / (1.0 - reflectance * thrown_back)


def repeated(color, thrown_back: np.ndarray) -> np.ndarray:
    """c^2 (1 - r) / (1 - c r), the factor of light that the base reflects at least twice, relative to that of a white
    base; `color` broadcasts to r."""
    return color**2 * (1.0 - thrown_back) / (1.0 - color * thrown_back)


def thrown_back(dark: np.ndarray, half: np.ndarray, light: np.ndarray) -> np.ndarray:
    """r, from albedos at the reflectances 0, 1/2 and 1: the share q = (1 - r) / (2 - r) of the change from 0 to 1 is
    reached at 1/2. 0 where no light reaches the base."""
    change = light - dark
    seen = change > LEAST
    q = np.clip(np.where(seen, half - dark, 0.5) / np.where(seen, change, 1.0), 0.0, 0.5)
    return (1.0 - 2.0 * q) / (1.0 - q)
