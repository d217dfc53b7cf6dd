# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles as a measuring instrument: unbiased settings, linear pixels, independent seeds."""

import contextlib
import os
import sys
import tempfile
import time

import bpy
import numpy as np

PROGRESS_SECONDS = 10.0


def unbiased(scene, width, height, samples, bounces):
    """Settings for which a pixel's mean is its radiance, without clamping, filtering, guiding and adaptive sampling.

    `bounces` is the length of the longest path, scattering in volumes included.
    """
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    scene.render.film_transparent = False
    image = scene.render.image_settings
    image.file_format, image.color_depth, image.exr_codec = "OPEN_EXR", "32", "NONE"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = samples
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.use_guiding = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.light_sampling_threshold = 0.0
    cycles.blur_glossy = 0.0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.max_bounces = cycles.volume_bounces = bounces
    cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = bounces
    cycles.transparent_max_bounces = 64
    cycles.film_exposure = 1.0
    # Use a box filter of one pixel, so that neighbouring pixels share no samples.
    cycles.pixel_filter_type = "BOX"


def denoised(scene):
    """Remove noise by Open Image Denoise, with passes of albedo and normals: for pictures from which nothing is
    measured."""
    scene.cycles.use_denoising = True
    scene.cycles.denoiser = "OPENIMAGEDENOISE"
    scene.cycles.denoising_input_passes = "RGB_ALBEDO_NORMAL"


def render(scene, seed=0):
    """(linear RGB pixels, float64 (height, width, 3), first row on top; seconds that the render took)."""
    scene.cycles.seed = seed
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "render.exr")
        scene.render.filepath = path
        start = time.perf_counter()
        with quiet():
            bpy.ops.render.render(write_still=True, scene=scene.name)
        return read(path), time.perf_counter() - start


def render_seeds(scene, count, say=lambda text: None, first_seed=0):
    """`count` renders that differ only in the seed: (pixels (count, height, width, 3), seconds)."""
    pictures, total, said = [], 0.0, 0.0
    for k in range(count):
        picture, seconds = render(scene, first_seed + k)
        pictures.append(picture)
        total += seconds
        if total - said >= PROGRESS_SECONDS or k + 1 == count:
            say(f"seed {k + 1} of {count}, {total:.1f} s")
            said = total
    return np.stack(pictures), total


def read(path):
    """The RGB of an image file without any colour transform, float64 (height, width, 3), first row on top."""
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    width, height = image.size
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(height, width, image.channels)
    bpy.data.images.remove(image)
    return pixels[::-1, :, :3].astype(float)


@contextlib.contextmanager
def quiet():
    """Keep Blender's own output (written below Python's level) off the standard output."""
    sys.stdout.flush()
    stdout = os.dup(1)
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        try:
            yield
        finally:
            os.dup2(stdout, 1)
            os.close(stdout)
