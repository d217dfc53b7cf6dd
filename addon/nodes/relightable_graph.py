# SPDX-License-Identifier: GPL-3.0-or-later
"""Subsurface Scattering nodes with the inputs from lamina.subsurface_nodes, below the stack's boundary."""

import numpy as np

from . import boundary_graph


def draw(graph, inputs, length):
    """Add the nodes and return (the shader's socket, None): there is no volume.

    `inputs`: lamina.SubsurfaceInputs in millimetres; `length`: the socket with the number of Blender units
    per millimetre."""
    shader = _walk(graph, 0, "walk", inputs, inputs.color, inputs.radius, length)
    if inputs.extra_weight > 0.0:
        colour, radius = inputs.extra_color, inputs.extra_radius
        lost = _walk(graph, 4, "light that the walk loses", inputs, colour, radius, length)
        share = graph.node("ShaderNodeMixShader", 1, 4, "its share")
        share.inputs[0].default_value = inputs.extra_weight
        graph.link(lost, share.inputs[2])
        both = graph.node("ShaderNodeAddShader", 2, 2, "all that leaves")
        graph.link(shader, both.inputs[0])
        graph.link(share.outputs[0], both.inputs[1])
        shader = both.outputs[0]
    if inputs.has_boundary:
        shader = boundary_graph.over(graph, inputs.ior, inputs.roughness, shader)
    return shader, None


def _walk(graph, row, label, inputs, colour, radius, length):
    node = graph.node("ShaderNodeSubsurfaceScattering", 0, row, label)
    node.falloff = "RANDOM_WALK"
    node.inputs["Color"].default_value = (*_rgb(colour), 1.0)
    node.inputs["Radius"].default_value = _rgb(radius)
    node.inputs["IOR"].default_value = inputs.ior
    node.inputs["Roughness"].default_value = inputs.roughness
    node.inputs["Anisotropy"].default_value = inputs.anisotropy
    graph.link(length, node.inputs["Scale"])
    return node.outputs[0]


def _rgb(values):
    return tuple(float(value) for value in np.broadcast_to(values, 3))
