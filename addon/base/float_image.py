# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers as a packed float32 image that Cycles reads unchanged."""

import bpy
import numpy as np


def create(name, texels):
    """A new image of `texels`, (height, width, 4), bottom row first. It has no user yet."""
    height, width, _ = texels.shape
    image = bpy.data.images.new(name, width, height, alpha=True, float_buffer=True, is_data=True)
    # Defaults differ between Blender versions: set both explicitly.
    image.colorspace_settings.name = "Non-Color"
    image.alpha_mode = "CHANNEL_PACKED"
    image.pixels.foreach_set(np.ascontiguousarray(texels, np.float32).ravel())
    image.update()
    image.pack()
    return image
