# SPDX-License-Identifier: GPL-3.0-or-later
"""The shader of a base below the layers, inside the group: a Principled BSDF, or another shader, which the
group's input gives. The values of the BSDF come from the stack or from the group's inputs; its weight is the
share of its light that the layers neither scatter nor absorb."""

from . import principled
from .graph import NEVER_ZERO, rgba

SHADER = "Base"  # the group's inputs
REFLECTANCE = "Base Reflectance"
_LABEL = "base"


def with_principled(graph, lut, inputs, normal, weight, layers):
    """The shader `layers` plus the BSDF times `weight`, a value with equal channels. `inputs`: the group's,
    by name."""
    base = lut.header["stack"]["base"]
    bsdf = graph.node("ShaderNodeBsdfPrincipled", _LABEL)
    for name, socket in principled.SOCKETS.items():
        if name in base.get("inputs", ()):
            graph.link(inputs[socket], bsdf.inputs[socket])
        else:
            bsdf.inputs[socket].default_value = value(name, base[name])
    graph.link(normal, bsdf.inputs["Normal"])
    if principled.TANGENT in inputs:
        graph.link(inputs[principled.TANGENT] + NEVER_ZERO, bsdf.inputs[principled.TANGENT])
    if base["coat"][0] > 0.0:
        graph.link(normal, bsdf.inputs["Coat Normal"])
    for socket in bsdf.inputs:
        socket.hide = not socket.is_linked
    weighted = graph.weighted_shader("weighted", weight, bsdf.outputs[0])
    return graph.add_shaders("layers and base", layers, weighted)


def keep_facets(group, replaced):
    """Give the BSDF inside the node group the microfacet distribution and the anisotropy of the BSDF
    `replaced`, which it stands for; None: those of a new BSDF. With GGX, light is lost between facets, and
    rough metals are darker."""
    for node in group.nodes:
        if node.type == "BSDF_PRINCIPLED" and node.label == _LABEL:
            node.distribution = replaced.distribution if replaced is not None else "MULTI_GGX"
            given = principled.anisotropy(replaced) if replaced is not None else (0.0, 0.0)
            for name, number in zip(principled.ANISOTROPY, given, strict=True):
                node.inputs[name].default_value = number


def value(name, channels):
    """The value of the socket for a quantity of PrincipledBase, given as in the table's header: a list of one
    number, or of one per channel."""
    return rgba(channels) if name == "color" else float(channels[0])


def with_shader(graph, inputs, weight, layers):
    """The shader `layers`, the layers' own light, plus the shader of the input SHADER times `weight`.

    The weight, a color, is made grey, because Cycles has no colored weights of shaders.
    `inputs`: the group's, by name."""
    grey = graph.node("ShaderNodeRGBToBW", "grey")
    graph.link(weight, grey.inputs[0])
    weighted = graph.weighted_shader("weighted base", grey.outputs[0], inputs[SHADER])
    return graph.add_shaders("layers and base", layers, weighted)
