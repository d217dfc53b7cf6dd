# SPDX-License-Identifier: GPL-3.0-or-later
"""The Principled BSDF of a base, inside the group: with the values of the stack or of the group's inputs, and
the weight that the layers leave it."""

from . import mix_shader, principled


def beside(graph, lut, inputs, normal, weight, layers):
    """The shader `layers` plus the BSDF times `weight`, a socket with equal channels. `inputs`: the group's
    input node; `normal`: a socket."""
    base = lut.header["stack"]["base"]
    bsdf = graph.node("ShaderNodeBsdfPrincipled", 10.6, -3, "base")
    for name, socket in principled.SOCKETS.items():
        if name in base.get("inputs", ()):
            graph.link(inputs.outputs[socket], bsdf.inputs[socket])
        else:
            bsdf.inputs[socket].default_value = _value(name, base[name])
    graph.link(normal, bsdf.inputs["Normal"])
    if base["coat"][0] > 0.0:
        graph.link(normal, bsdf.inputs["Coat Normal"])
    for socket in bsdf.inputs:
        socket.hide = not socket.is_linked
    weighted = graph.node("ShaderNodeMixShader", 12, -3, "weighted")
    graph.link(weight, weighted.inputs[0])
    graph.link(bsdf.outputs[0], weighted.inputs[2])
    return mix_shader.added(graph, 13.2, -2, "layers and base", layers, weighted.outputs[0])


def _value(name, channels):
    """The value of a socket, from a number per channel."""
    if name == "color":
        return (*(channels * 3 if len(channels) == 1 else channels), 1.0)
    return channels[0]
