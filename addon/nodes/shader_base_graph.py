# SPDX-License-Identifier: GPL-3.0-or-later
"""The nodes of a base that another shader renders: the shader's weight below the layers."""

from . import mix_shader

SHADER = "Base"  # the group's inputs
REFLECTANCE = "Base Reflectance"


def over(graph, inputs, weight, thrown_back, layers):
    """The shader `layers`, the layers' own light, plus the shader of the input SHADER.

    The latter has the weight w / (1 - c r), made grey, because Cycles has no colored weights of shaders.
    `weight`, `thrown_back`: w and r as sockets; `inputs`: the group's input node, whose input REFLECTANCE is
    c."""
    again = graph.vector("MULTIPLY", 9.2, -3, "c r", inputs.outputs[REFLECTANCE], thrown_back)
    rest = graph.vector("SUBTRACT", 10.2, -3, "1 - c r", (1.0, 1.0, 1.0), again)
    share = graph.vector("DIVIDE", 11.2, -3, "w / (1 - c r)", weight, rest)
    grey = graph.node("ShaderNodeRGBToBW", 12.2, -3, "grey")
    graph.link(share, grey.inputs[0])
    shader = graph.node("ShaderNodeMixShader", 13.2, -3, "weighted base")
    graph.link(grey.outputs[0], shader.inputs[0])
    graph.link(inputs.outputs[SHADER], shader.inputs[2])
    return mix_shader.added(graph, 13.2, -2, "layers and base", layers, shader.outputs[0])
