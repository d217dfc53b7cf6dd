# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders of temporary scenes, as arrays of exact values."""

import os
import tempfile

import bpy
import numpy as np

from ..base import renders


def prepare(scene, width, height):
    """Settings of a scene for exact values: an image of this size, no clamping, denoising or bounces.
    Raises RefusedError in Blender before 5.2 while a preview is rendered."""
    renders.end_previews()
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    scene.render.film_transparent = False
    scene.render.use_compositing = scene.render.use_sequencer = False
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_mode = "RGB"
    scene.render.image_settings.color_depth = "32"
    scene.render.image_settings.exr_codec = "NONE"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.max_bounces = 0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.film_exposure = 1.0
    cycles.pixel_filter_type = "BLACKMAN_HARRIS"


def picture(scene):
    """Render one image: array [row from the bottom, column, channel]. Main thread only."""
    with tempfile.TemporaryDirectory(prefix="lamina-render-") as folder:
        scene.render.filepath = os.path.join(folder, "picture.exr")
        with renders.own_render():
            bpy.ops.render.render(write_still=True, scene=scene.name)
        image = bpy.data.images.load(scene.render.filepath)
        try:
            image.colorspace_settings.name = "Non-Color"
            width, height = image.size
            pixels = np.empty(width * height * image.channels, np.float32)
            image.pixels.foreach_get(pixels)
            return pixels.reshape(height, width, -1)
        finally:
            bpy.data.images.remove(image)
