# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours for displays."""

from __future__ import annotations

import numpy as np

LUMINANCE = (0.2126, 0.7152, 0.0722)  # of linear Rec. 709, as Blender's node for grey values has them


def srgb(linear) -> np.ndarray:
    """Linear Rec. 709 values as sRGB (IEC 61966-2-1), clipped to [0, 1]."""
    linear = np.clip(linear, 0.0, 1.0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1.0 / 2.4) - 0.055)


def linear(srgb: np.ndarray) -> np.ndarray:
    """Linear Rec. 709 values of sRGB values in [0, 1]."""
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
