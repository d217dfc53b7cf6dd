# SPDX-License-Identifier: GPL-3.0-or-later
"""A sphere of radius 1 under a sun without angle, 45 degrees from the view, and references for it.

The references are means of 4 x 4 pixels, by renders of Cycles' volume and by walks (tests/data). The medium has an
albedo of .9."""

import json
import math
from pathlib import Path

import bpy
import goniophotometer
import numpy as np

from lamina import HenyeyGreenstein, Interface, Isotropic, Medium, Stack

DATA = Path(__file__).parents[1] / "data"
NAMES = ("portal_sphere", "portal_sphere_boundary", "portal_sphere_forward")
BLOCKS = {(name, path): np.array(blocks) for name in NAMES
          for path, blocks in json.loads((DATA / f"{name}.json").read_text())["paths"].items()}


def stack(name, path):
    """The half-space with the medium of a reference, its mean free path in metres."""
    extinction = 0.001 / float(path)  # per millimetre
    phase = HenyeyGreenstein(0.8) if name == "portal_sphere_forward" else Isotropic()
    medium = Medium(sigma_s=[0.9 * extinction], sigma_a=[0.1 * extinction], thickness=np.inf, phase=phase)
    return Stack([Interface(1.4), medium] if name == "portal_sphere_boundary" else [medium])


def blocks(material, samples, seed, prepare):
    """Means of 4 x 4 pixels of a render, shape (16, 16)."""
    return blocks_of(pixels(material, samples, seed, prepare))


def blocks_of(picture):
    return picture.reshape(16, 4, 16, 4).mean(axis=(1, 3))


def pixels(material, samples, seed, prepare):
    """The red channel of a render, shape (64, 64). `prepare(scene)` is called before the render."""
    scene = bpy.data.scenes.new("sphere")
    mesh = _sphere(material)
    scene.collection.objects.link(bpy.data.objects.new("sphere", mesh))
    camera = bpy.data.cameras.new("eye")
    camera.type, camera.ortho_scale = "ORTHO", 2.2
    scene.camera = bpy.data.objects.new("eye", camera)
    scene.collection.objects.link(scene.camera)
    scene.camera.location = (0.0, 0.0, 10.0)
    lamp = bpy.data.lights.new("sun", "SUN")
    lamp.angle, lamp.energy = 0.0, math.pi
    sun = bpy.data.objects.new("sun", lamp)
    scene.collection.objects.link(sun)
    sun.rotation_euler = (0.0, math.radians(45.0), math.radians(25.0))
    scene.world = goniophotometer._world(0.0)
    goniophotometer._settings(scene, samples, 1)
    scene.cycles.max_bounces, scene.cycles.seed = 8, seed
    scene.render.resolution_x = scene.render.resolution_y = 64
    prepare(scene)
    try:
        found = goniophotometer._render(scene)
    finally:
        bpy.data.scenes.remove(scene)
        bpy.data.meshes.remove(mesh)
        bpy.data.cameras.remove(camera)
        bpy.data.lights.remove(lamp)
    return found[..., 0]


def _sphere(material, turns=192, rings=96):
    """A sphere of radius 1 by angles, with the poles on the z axis."""
    up, turn = np.meshgrid(np.arange(1, rings) * np.pi / rings, np.arange(turns) * 2.0 * np.pi / turns, indexing="ij")
    corners = np.stack([np.sin(up) * np.cos(turn), np.sin(up) * np.sin(turn), np.cos(up)], axis=-1).reshape(-1, 3)
    corners = np.concatenate([corners, [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]])
    top, bottom = len(corners) - 2, len(corners) - 1
    faces = []
    for k in range(turns):
        after = (k + 1) % turns
        faces.append((top, k, after))
        faces += [(r * turns + k, (r + 1) * turns + k, (r + 1) * turns + after, r * turns + after)
                  for r in range(rings - 2)]
        faces.append((bottom, (rings - 2) * turns + after, (rings - 2) * turns + k))
    mesh = bpy.data.meshes.new("sphere")
    mesh.from_pydata(corners.tolist(), [], faces)
    mesh.materials.append(material)
    return mesh
