# SPDX-License-Identifier: GPL-3.0-or-later
"""A grey sky with a bright round cap in it, as a node world and as plain numbers."""

import math

import bpy
import node_tree
import numpy as np
from mathutils import Vector

CAP_ELEVATION = math.radians(32.0)
CAP_RADIUS = math.radians(28.0)
CAP, SKY = 3.0, 0.5  # radiances


def towards_cap(azimuth):
    """Unit vector to the middle of the cap; azimuth in radians from +x."""
    across = math.cos(CAP_ELEVATION)
    return Vector((across * math.cos(azimuth), across * math.sin(azimuth), math.sin(CAP_ELEVATION)))


def world(azimuth, cap=CAP, sky=SKY, aimed=True):
    """A new world with the cap at this azimuth; with cap = sky the sky is uniform.

    `aimed`: Cycles also samples the world by importance. Not for rough glass, which Cycles then evaluates for facets
    that its own sampling leaves out: a rough coat becomes up to 8 % too bright."""
    made = bpy.data.worlds.new("sky with a cap")
    made.cycles.sampling_method = "MANUAL" if aimed else "NONE"
    made.cycles.sample_map_resolution = 512
    tree = node_tree.of(made)
    tree.nodes.clear()
    direction = tree.nodes.new("ShaderNodeTexCoord")
    cosine = tree.nodes.new("ShaderNodeVectorMath")
    cosine.operation = "DOT_PRODUCT"
    tree.links.new(direction.outputs["Generated"], cosine.inputs[0])
    cosine.inputs[1].default_value = towards_cap(azimuth)
    inside = tree.nodes.new("ShaderNodeMath")
    inside.operation = "GREATER_THAN"
    tree.links.new(cosine.outputs["Value"], inside.inputs[0])
    inside.inputs[1].default_value = math.cos(CAP_RADIUS)
    strength = tree.nodes.new("ShaderNodeMath")
    strength.operation = "MULTIPLY_ADD"
    tree.links.new(inside.outputs[0], strength.inputs[0])
    strength.inputs[1].default_value, strength.inputs[2].default_value = cap - sky, sky
    background = tree.nodes.new("ShaderNodeBackground")
    background.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    tree.links.new(strength.outputs[0], background.inputs["Strength"])
    output = tree.nodes.new("ShaderNodeOutputWorld")
    tree.links.new(background.outputs[0], output.inputs["Surface"])
    return made


def cap_rule(rings=16, spokes=32):
    """Directions of a quadrature over the cap: (cosine with the vertical, azimuth from the cap's middle, solid angle),
    all flat arrays."""
    x, w = np.polynomial.legendre.leggauss(rings)
    low = math.cos(CAP_RADIUS)
    height, weight = low + 0.5 * (x + 1.0) * (1.0 - low), 0.5 * w * (1.0 - low)
    around = (np.arange(spokes) + 0.5) * 2.0 * math.pi / spokes
    c, phi = (part.ravel() for part in np.meshgrid(height, around, indexing="ij"))
    s = np.sqrt(1.0 - c * c)
    up = c * math.sin(CAP_ELEVATION) + s * np.cos(phi) * math.cos(CAP_ELEVATION)
    ahead = c * math.cos(CAP_ELEVATION) - s * np.cos(phi) * math.sin(CAP_ELEVATION)
    return up, np.arctan2(s * np.sin(phi), ahead), np.repeat(weight, spokes) * 2.0 * math.pi / spokes
