# SPDX-License-Identifier: GPL-3.0-or-later
"""The LUT as a packed float32 image.

The height is rounded up to a power of two, so that every texel centre is exact in float32 and no
strip bleeds into its neighbour by rounding: weights of two strips may differ a thousandfold.
"""

import numpy as np

from ..base import data_image


def height_of(lut):
    """Height of the image in texels: that of `lut.image()`, rounded up to a power of two."""
    return 1 << (len(lut.image()) - 1).bit_length()


def create(name, lut):
    """A new image that holds `lut.image()` in its lower rows. It has no user yet."""
    texels = np.ascontiguousarray(lut.image(), dtype=np.float32)
    rows, width, _ = texels.shape
    padded = np.zeros((height_of(lut), width, 4), dtype=np.float32)
    padded[:rows] = texels
    padded[rows:, :, 3] = 1.0
    return data_image.create(name, padded)
