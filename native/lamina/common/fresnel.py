# SPDX-License-Identifier: GPL-3.0-or-later
"""Fresnel's equations for a smooth dielectric."""

from __future__ import annotations

import numpy as np


def fresnel(cosine, ior: float) -> np.ndarray:
    """Unpolarised reflectance of a dielectric of relative index `ior`; 1 beyond the critical angle."""
    refracted2 = ior * ior - 1.0 + cosine**2
    g = np.sqrt(np.maximum(refracted2, 0.0))
    a = (g - cosine) / (g + cosine)
    b = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0)
    return np.where(refracted2 > 0.0, 0.5 * a * a * (1.0 + b * b), 1.0)
