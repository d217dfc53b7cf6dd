# SPDX-License-Identifier: GPL-3.0-or-later
"""Subsurface Scattering nodes with the inputs from lamina.subsurface_nodes, below the stack's boundary."""

import numpy as np

from . import boundary_graph


def draw(graph, inputs, length, texels=None):
    """Add the nodes and return (the shader's socket, None): there is no volume.

    `inputs`: lamina.SubsurfaceInputs in millimetres; `length`: the number of Blender units per millimetre, a
    socket or a value. If the inputs are images, `texels(name, pixels)` adds an image of (height, width, 3)
    and returns its colour."""
    shader = _walk(graph, "walk", inputs, "", length, texels)
    if inputs.extra_weight > 0.0:
        lost = _walk(graph, "light that the walk loses", inputs, "extra_", length, texels)
        share = graph.weighted_shader("its share", inputs.extra_weight, lost)
        shader = graph.add_shaders("all that leaves", shader, share)
    if inputs.has_boundary:
        shader = boundary_graph.over(graph, inputs.ior, inputs.roughness, shader)
    return shader, None


def _walk(graph, label, inputs, prefix, length, texels):
    node = graph.node("ShaderNodeSubsurfaceScattering", label)
    node.falloff = "RANDOM_WALK"
    colour, radius = getattr(inputs, f"{prefix}color"), getattr(inputs, f"{prefix}radius")
    if texels is None:
        node.inputs["Color"].default_value = (*_rgb(colour), 1.0)
        node.inputs["Radius"].default_value = _rgb(radius)
    else:
        graph.link(texels(f"{prefix}color", colour), node.inputs["Color"])
        graph.link(texels(f"{prefix}radius", radius), node.inputs["Radius"])
    node.inputs["IOR"].default_value = inputs.ior
    node.inputs["Roughness"].default_value = inputs.roughness
    node.inputs["Anisotropy"].default_value = inputs.anisotropy
    graph.link(length, node.inputs["Scale"])
    return node.outputs[0]


def _rgb(values):
    return tuple(float(value) for value in np.broadcast_to(values, 3))
