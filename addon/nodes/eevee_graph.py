# SPDX-License-Identifier: GPL-3.0-or-later
"""The closures that Eevee renders in place of those for Cycles: few, of kinds that Eevee has, with the same
directional albedo (see lamina.baking.table.real_time).

A Mix Shader chooses by its factor. A node that only Eevee knows, Shader to RGB, feeds the factor: Eevee finds
1. Cycles ignores links from nodes that it does not know, and finds the factor's own value, 0. It then leaves
out Eevee's closures before rendering.
"""

from ..kinds.table import BASE
from . import lut_image
from .expression import clamped

LABEL = "Eevee"
_STRAIGHT_ON = ("through", "straight")
_WITH_ROUGHNESS = ("glossy", "mirror", *_STRAIGHT_ON)

# Index of the refraction for light that comes through a sheet. Eevee makes the lobe of the index 3/2 narrower
# than the roughness says, by this factor.
_IOR, _NARROWING = 1.5, (1.0 - 1.0 / 1.5) ** 0.5

_GLOSSY = ("ShaderNodeBsdfAnisotropic", {"distribution": "MULTI_GGX"})
_REFRACTION = ("ShaderNodeBsdfRefraction", {"distribution": "GGX"})
_NODES = {
    "diffuse": ("ShaderNodeBsdfDiffuse", {}),
    "glossy": _GLOSSY,
    "mirror": _GLOSSY,
    "translucent": ("ShaderNodeBsdfTranslucent", {}),
    "through": _REFRACTION,
    "straight": _REFRACTION,
    "transparent": ("ShaderNodeBsdfTransparent", {}),
}


def is_eevee(graph):
    """A socket for factors with the value 0 of their own: 1 in Eevee, nothing in Cycles."""
    light = graph.node("ShaderNodeEmission", "1")
    found = graph.node("ShaderNodeShaderToRGB", "1 in Eevee, no node in Cycles")
    graph.link(light.outputs[0], found.inputs[0])
    return found.outputs[0]


def totals(graph, lut, eevee, texels, factors, normal, incoming):
    """{whether of a metal: shader} of the closures of `eevee`, a RealTimeTable.

    `texels`: strip_reader.Texels. `factors`: of the strips, by role and metal."""
    found = {}
    for number, strip in enumerate(eevee.strips):
        weight, *roughness = texels.read(lut_image.eevee_strip(lut, number), f"{LABEL} {strip.name}",
                                         alpha=strip.closure in _WITH_ROUGHNESS)
        if strip.role == BASE:
            weight = weight * factors[BASE, strip.metal]
        shader = _closure(graph, strip.closure, weight, roughness, normal, incoming)
        if strip.metal in found:
            shader = graph.add_shaders("", found[strip.metal], shader)
        found[strip.metal] = shader
    return found


def chosen(graph, chooser, cycles, eevee):
    """The shader `cycles` in Cycles, the shader `eevee` in Eevee. `chooser`: the socket of `is_eevee`."""
    shader = graph.mix_shaders("Cycles or Eevee", 0.0, cycles, eevee)
    graph.link(chooser, shader.node.inputs[0])
    return shader


def chosen_value(graph, chooser, cycles, eevee, kind="RGBA"):
    """The same of two colors, or of two numbers with the `kind` "FLOAT"."""
    value = graph.mix(kind, "Cycles or Eevee", chooser, cycles, eevee)
    value.socket.node.inputs[0].default_value = 0.0
    return value


def scaled(graph, chooser, color, factor):
    """`color` in Cycles, `color` times `factor` in Eevee."""
    if factor == 1.0:
        return color
    return chosen_value(graph, chooser, color, color * factor)


def dark(graph, chooser, color):
    """`color` in Cycles, black in Eevee. Eevee raises the tint of a coat to the power 1 / (view cosine). This
    overflows near grazing, and then even a shader without weight is not a number."""
    value = graph.mix("RGBA", "Cycles only", chooser, color, (0.0, 0.0, 0.0, 1.0))
    value.socket.node.inputs[0].default_value = 0.0
    return value


def _closure(graph, kind, weight, roughness, normal, incoming):
    type_name, enums = _NODES[kind]
    node = graph.node(type_name, f"{LABEL} {kind}")
    for key, value in enums.items():
        setattr(node, key, value)
    graph.link(weight, node.inputs["Color"])
    if kind in _STRAIGHT_ON:
        # About the view direction, a refraction goes straight on.
        graph.link(incoming, node.inputs["Normal"])
        node.inputs["IOR"].default_value = _IOR
        graph.link(clamped(roughness[0] / _NARROWING), node.inputs["Roughness"])
    elif "Normal" in node.inputs:
        graph.link(normal, node.inputs["Normal"])
    if type_name == "ShaderNodeBsdfAnisotropic":
        graph.link(roughness[0], node.inputs["Roughness"])
    for socket in node.inputs:
        socket.hide = not socket.is_linked
    return node.outputs[0]
