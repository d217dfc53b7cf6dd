# SPDX-License-Identifier: GPL-3.0-or-later
"""Sun and sky of the slab scene, as Blender data and as the same numbers in numpy.

The sun is a delta light. The sky is a gradient from zenith to horizon and black below the horizon, so nothing lights
the slab from below and its radiance can be computed from a scattering function.
"""

import math

import bpy
import node_tree
import numpy as np
from mathutils import Matrix, Vector

SUN_ELEVATION = math.radians(12.0)
SUN_IRRADIANCE = (3.6, 2.2, 1.0)  # perpendicular to the beam
ZENITH = (0.05, 0.20, 0.60)
HORIZON = (0.35, 0.45, 0.55)
FALLOFF = 4  # radiance = ZENITH + (HORIZON - ZENITH) (1 - mu)^FALLOFF


def sky_radiance(mu):
    """Radiance of the sky at the cosine `mu` with the zenith, shape (..., 3); black for mu < 0."""
    mu = np.asarray(mu, float)[..., None]
    gradient = np.array(ZENITH) + np.subtract(HORIZON, ZENITH) * (1.0 - np.clip(mu, 0.0, 1.0)) ** FALLOFF
    return np.where(mu >= 0.0, gradient, 0.0)


def towards_sun(azimuth, elevation=SUN_ELEVATION):
    """Unit vector to the sun; azimuth in radians from +x."""
    height, across = math.sin(elevation), math.cos(elevation)
    return Vector((across * math.cos(azimuth), across * math.sin(azimuth), height))


def build(scene, sun_azimuth, sun_elevation=SUN_ELEVATION):
    """Add sun and sky to `scene`."""
    lamp = bpy.data.lights.new("sun", "SUN")
    lamp.angle = 0.0
    lamp.energy = max(SUN_IRRADIANCE)
    lamp.color = [value / lamp.energy for value in SUN_IRRADIANCE]
    sun = bpy.data.objects.new("sun", lamp)
    scene.collection.objects.link(sun)
    sun.matrix_world = frame(towards_sun(sun_azimuth, sun_elevation))
    scene.world = _sky()


def frame(z):
    """A rotation whose local z axis is `z`: lamps and cameras look along -z; x stays horizontal."""
    x = Vector((0.0, 0.0, 1.0)).cross(z)
    x = x.normalized() if x.length > 1e-6 else Vector((1.0, 0.0, 0.0))
    return Matrix((x, z.cross(x), z)).transposed().to_4x4()


def _sky():
    world = bpy.data.worlds.new("sky")
    # The gradient is smooth: a small importance map is enough and keeps the start of a render short.
    world.cycles.sampling_method = "MANUAL"
    world.cycles.sample_map_resolution = 256
    tree = node_tree.of(world)
    tree.nodes.clear()
    direction = tree.nodes.new("ShaderNodeTexCoord")
    split = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(direction.outputs["Generated"], split.inputs[0])
    height = split.outputs[2]
    weight = _math(tree, "POWER", _math(tree, "SUBTRACT", 1.0, height, clamp=True), FALLOFF)
    above = _math(tree, "GREATER_THAN", height, 0.0)
    zenith = _scaled(tree, ZENITH, None)
    colour = _scaled(tree, np.subtract(HORIZON, ZENITH), weight)
    total = tree.nodes.new("ShaderNodeVectorMath")
    total.operation = "ADD"
    tree.links.new(zenith, total.inputs[0])
    tree.links.new(colour, total.inputs[1])
    background = tree.nodes.new("ShaderNodeBackground")
    tree.links.new(total.outputs[0], background.inputs["Color"])
    tree.links.new(above, background.inputs["Strength"])
    output = tree.nodes.new("ShaderNodeOutputWorld")
    tree.links.new(background.outputs[0], output.inputs["Surface"])
    return world


def _math(tree, operation, a, b, clamp=False):
    node = tree.nodes.new("ShaderNodeMath")
    node.operation, node.use_clamp = operation, clamp
    for socket, value in zip(node.inputs, (a, b), strict=False):
        if isinstance(value, (int, float)):
            socket.default_value = value
        else:
            tree.links.new(value, socket)
    return node.outputs[0]


def _scaled(tree, vector, factor):
    node = tree.nodes.new("ShaderNodeVectorMath")
    node.operation = "SCALE"
    node.inputs[0].default_value = tuple(float(value) for value in vector)
    node.inputs["Scale"].default_value = 1.0
    if factor is not None:
        tree.links.new(factor, node.inputs["Scale"])
    return node.outputs[0]
