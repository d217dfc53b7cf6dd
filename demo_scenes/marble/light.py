# SPDX-License-Identifier: GPL-3.0-or-later
"""Sun and sky, as Blender data and as the lamp of `lamina.light_in_mesh`. The sky is the same in all directions."""

import math

import bpy
import node_tree
import numpy as np
from slab.light import frame, towards_sun

SUN_AZIMUTH, SUN_ELEVATION = math.radians(125.0), math.radians(38.0)
TOWARDS_SUN = towards_sun(SUN_AZIMUTH, SUN_ELEVATION)
SUN = np.array((3.4, 2.75, 2.05))  # irradiance perpendicular to the beam
SKY = np.array((0.24, 0.36, 0.52))  # radiance


def build(scene):
    """Add sun and sky to `scene`."""
    lamp = bpy.data.lights.new("sun", "SUN")
    lamp.angle = 0.0
    lamp.energy = SUN.max()
    lamp.color = SUN / SUN.max()
    sun = bpy.data.objects.new("sun", lamp)
    scene.collection.objects.link(sun)
    sun.matrix_world = frame(TOWARDS_SUN)
    world = bpy.data.worlds.new("sky")
    # A constant sky needs no importance map.
    world.cycles.sampling_method = "NONE"
    tree = node_tree.of(world)
    tree.nodes.clear()
    background, output = tree.nodes.new("ShaderNodeBackground"), tree.nodes.new("ShaderNodeOutputWorld")
    background.inputs["Color"].default_value = (*SKY, 1.0)
    tree.links.new(background.outputs[0], output.inputs["Surface"])
    scene.world = world


def radiance(of_sun, of_sky):
    """The radiance under this light; arguments: for a sun of irradiance 1 and a sky of radiance 1, (..., 3)."""
    return of_sun * SUN + of_sky * SKY
