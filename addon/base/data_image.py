# SPDX-License-Identifier: GPL-3.0-or-later
"""Packed images that hold numbers, which Cycles reads unchanged."""

from pathlib import Path

import bpy
import numpy as np

made = set()  # session_uid of every image that was made since Blender's start, see undo


def create(name, texels):
    """A new float32 image of `texels`, (height, width, 4), bottom row first. It has no user yet."""
    height, width, _ = texels.shape
    image = bpy.data.images.new(name, width, height, alpha=True, float_buffer=True, is_data=True)
    # Defaults differ between Blender versions: set both explicitly.
    image.colorspace_settings.name = "Non-Color"
    image.alpha_mode = "CHANNEL_PACKED"
    image.pixels.foreach_set(np.ascontiguousarray(texels, np.float32).ravel())
    image.update()
    image.pack()
    made.add(image.session_uid)
    return image


def plain(name, size, value=0.0, float_buffer=False):
    """A new opaque image of `size` x `size` texels of this value. It has no user yet."""
    image = bpy.data.images.new(name, size, size, alpha=False, float_buffer=float_buffer, is_data=True)
    texels = np.full((size * size, 4), value, np.float32)
    texels[:, 3] = 1.0
    image.pixels.foreach_set(texels.ravel())  # a generated image without assigned pixels cannot be packed
    image.update()
    image.pack()
    made.add(image.session_uid)
    return image


def is_lost(image):
    """True if the image is not packed and its file is gone: nodes then read pink."""
    path = bpy.path.abspath(image.filepath, library=image.library)
    return image.packed_file is None and image.source == "FILE" and not Path(path).is_file()
