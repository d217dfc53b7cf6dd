# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in Blender: renders the opened file and prints the hash of the pixels, and whether Lamina is enabled."""

import hashlib
import os

import bpy
import numpy as np

scene = bpy.context.scene
scene.render.resolution_x = scene.render.resolution_y = 32
scene.render.threads_mode, scene.render.threads = "FIXED", 1
scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
scene.cycles.samples, scene.cycles.seed = 8, 0
scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
scene.render.filepath = f"{os.environ['HOME']}/picture.exr"
bpy.ops.render.render(write_still=True)
image = bpy.data.images.load(scene.render.filepath)
pixels = np.array(image.pixels[:], np.float32)
print("mean:", float(pixels.reshape(-1, 4)[:, :3].mean()))
print("pixels:", hashlib.sha256(pixels.tobytes()).hexdigest())
print("lamina:", hasattr(bpy.types.Material, "lamina"))
