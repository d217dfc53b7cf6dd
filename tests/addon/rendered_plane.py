# SPDX-License-Identifier: GPL-3.0-or-later
"""A small scene to render: a tilted plane under a sun and sky."""

import bpy
from addon_helpers import pixels

SIZE = 24


def add_plane(material):
    """A tilted plane with `material` under a sun and sky, seen by an orthographic camera."""
    scene = bpy.context.scene
    mesh = bpy.data.meshes.new("Patch")
    mesh.from_pydata([(-2, -2, 0), (2, -2, 0), (2, 2, 0.6), (-2, 2, 0.6)], [], [(0, 1, 2, 3)])
    mesh.materials.append(material)
    scene.collection.objects.link(bpy.data.objects.new("Patch", mesh))
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 3.0, 0.0
    lamp = bpy.data.objects.new("Sun", sun)
    lamp.rotation_euler = (0.7, 0.2, 0.0)
    scene.collection.objects.link(lamp)
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale = "ORTHO", 1.0
    eye = bpy.data.objects.new("Camera", camera)
    eye.location, eye.rotation_euler = (0.1, -2.0, 2.0), (0.785, 0.0, 0.0)
    scene.collection.objects.link(eye)
    scene.camera = eye
    scene.world = bpy.data.worlds.new("Sky")
    scene.render.engine = "CYCLES"
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.cycles.samples, scene.cycles.seed = 4, 0
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False


def render(path):
    """float32 (height, width, 4) of the present scene, bottom row first."""
    bpy.context.scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Non-Color"
    values = pixels(image)
    bpy.data.images.remove(image)
    return values
