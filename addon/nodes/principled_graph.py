# SPDX-License-Identifier: GPL-3.0-or-later
"""The Principled BSDF of a base, inside the group. Its values come from the stack or from the group's inputs;
its weight is the share of its light that the layers neither scatter nor absorb."""

from . import mix_shader, principled
from .graph import NEVER_ZERO, rgba

_LABEL = "base"


def beside(graph, lut, inputs, normal, weight, layers):
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
    weighted = mix_shader.weighted(graph, "weighted", weight, bsdf.outputs[0])
    return mix_shader.added(graph, "layers and base", layers, weighted)


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
