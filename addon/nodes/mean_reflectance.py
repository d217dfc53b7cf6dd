# SPDX-License-Identifier: GPL-3.0-or-later
"""An estimate of the mean reflectance of a shader, from the colors of its nodes.

Layers throw light back to the shader below, and the shader reflects a share of this light again. The estimate
is that share. The artist may correct it. Textured and unknown shaders count as half reflecting.
"""

from ..kinds import metals
from . import links

UNKNOWN = 0.5
GLASS = 0.1  # mean reflectance of a dielectric surface of index 1.5

# Types of nodes by their share of reflected light. The color of the node multiplies the share.
_COLOURED = {
    "BSDF_DIFFUSE": 1.0,
    "BSDF_GLOSSY": 1.0,
    "BSDF_METALLIC": 1.0,
    "BSDF_SHEEN": 0.5,
    "BSDF_TOON": 1.0,
    "SUBSURFACE_SCATTERING": 1.0,
    "BSDF_GLASS": GLASS,
    "BSDF_REFRACTION": 0.0,
    "BSDF_TRANSLUCENT": 0.0,
    "BSDF_TRANSPARENT": 0.0,
    "BSDF_RAY_PORTAL": 0.0,
    "EMISSION": 0.0,
    "HOLDOUT": 0.0,
}
_COLORS = ("Base Color", "Color")


def of(shader):
    """The mean reflectance, R G B in [0, 1], of the shader at the output socket `shader`."""
    return tuple(min(max(share, 0.0), 1.0) for share in _of(shader))


def _of(shader):
    node = shader.node if shader is not None else None
    if node is None:
        return (0.0,) * 3  # nothing is linked: black
    if node.mute:
        return (UNKNOWN,) * 3
    if node.type == "MIX_SHADER":
        return _mixed(node.inputs[0], *(_of(links.source(socket)) for socket in node.inputs[1:3]))
    if node.type == "ADD_SHADER":
        first, second = (_of(links.source(socket)) for socket in node.inputs)
        return tuple(one + other for one, other in zip(first, second, strict=True))
    if node.type == "BSDF_PRINCIPLED":
        return _of_principled(node)
    if node.type in _COLOURED:
        share, color = _COLOURED[node.type], _color(node) if _COLOURED[node.type] else (0.0,) * 3
        return tuple(share * channel for channel in color)
    if node.type == "GROUP" and node.node_tree is not None:
        for inside in node.node_tree.nodes:
            if inside.type == "GROUP_OUTPUT" and inside.is_active_output:
                return _of(links.source(_same(inside.inputs, shader)))
    return (UNKNOWN,) * 3


def _of_principled(node):
    """Its color, and where it transmits light, that of glass."""
    metallic, clear = (_number(node.inputs[name]) for name in ("Metallic", "Transmission Weight"))
    through = (1.0 - metallic) * clear
    return tuple((1.0 - through * (1.0 - GLASS)) * channel for channel in _color(node))


def _number(factor):
    return UNKNOWN if links.source(factor) is not None else min(max(factor.default_value, 0.0), 1.0)


def _mixed(factor, first, second):
    share = _number(factor)
    return tuple((1.0 - share) * one + share * other for one, other in zip(first, second, strict=True))


def _color(node):
    if getattr(node, "fresnel_type", "") == "PHYSICAL_CONDUCTOR":
        return _of_metal(node.inputs["IOR"], node.inputs["Extinction"])
    socket = next((node.inputs[name] for name in _COLORS if name in node.inputs), None)
    if socket is None or links.source(socket) is not None:
        return (UNKNOWN,) * 3
    return tuple(socket.default_value)[:3]


def _of_metal(ior, extinction):
    """What a metal of this complex index reflects at 45 degrees, near the mean angle between the light and
    the facets of a rough metal under a uniform sky."""
    if links.source(ior) is not None or links.source(extinction) is not None:
        return (UNKNOWN,) * 3
    return tuple(metals.reflectance(0.5**0.5, n, k)
                 for n, k in zip(ior.default_value, extinction.default_value, strict=True))


def _same(sockets, wanted):
    return next(socket for socket in sockets if socket.identifier == wanted.identifier)
