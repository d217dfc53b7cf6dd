# SPDX-License-Identifier: GPL-3.0-or-later
"""The nodes of a base that another shader renders: the shader's weight below the layers."""

from . import mix_shader

SHADER = "Base"  # the group's inputs
REFLECTANCE = "Base Reflectance"


def over(graph, inputs, weight, layers):
    """The shader `layers`, the layers' own light, plus the shader of the input SHADER times `weight`.

    The weight, a color, is made grey, because Cycles has no colored weights of shaders.
    `inputs`: the group's, by name."""
    grey = graph.node("ShaderNodeRGBToBW", "grey")
    graph.link(weight, grey.inputs[0])
    weighted = mix_shader.weighted(graph, "weighted base", grey.outputs[0], inputs[SHADER])
    return mix_shader.added(graph, "layers and base", layers, weighted)
