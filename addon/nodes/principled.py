# SPDX-License-Identifier: GPL-3.0-or-later
"""The Principled BSDF of a material: where it is, which values and links it has, and what layers over it
cannot carry."""

import json
from dataclasses import dataclass

from ..base.decimals import shortest
from ..kinds.bases import PrincipledBase
from . import links, node_tree, socket_animation

# The sockets that the quantities of the base are read from.
SOCKETS = {
    "color": "Base Color",
    "metallic": "Metallic",
    "roughness": "Roughness",
    "ior": "IOR",
    "specular": "Specular IOR Level",
    "coat": "Coat Weight",
    "coat_roughness": "Coat Roughness",
    "coat_ior": "Coat IOR",
}
NORMAL, ALPHA, TANGENT = "Normal", "Alpha", "Tangent"
ANISOTROPY = ("Anisotropic", "Anisotropic Rotation")
EMISSION, STRENGTH = "Emission Color", "Emission Strength"
COAT, COAT_IOR, COAT_NORMAL = "Coat Weight", "Coat IOR", "Coat Normal"

INPUTS = tuple(item.id for option in PrincipledBase.options if option.several for item in option.items)

_WHITE, _BLACK = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)
_SMOOTH_COAT = 0.1  # up to this roughness the coat dims the emission like a smooth one
_FIELDS = {field.name: field for field in PrincipledBase.fields}


@dataclass(frozen=True)
class _Part:
    """A part of the Principled BSDF that the base does not have. It has no effect while its socket `weight`
    has the value `none`, or where the part `under` ("dielectric" or "coat") has no weight. `is_large`:
    without the part the material is another one, such as plastic instead of glass."""

    words: str
    weight: str
    none: float | tuple = 0.0
    under: str = ""
    is_large: bool = False


_ANISOTROPIC = _Part("anisotropic highlights", ANISOTROPY[0])
_PARTS = (
    _Part("subsurface scattering", "Subsurface Weight", under="dielectric", is_large=True),
    _Part("transmission", "Transmission Weight", under="dielectric", is_large=True),
    _Part("sheen", "Sheen Weight", is_large=True),
    _Part("thin film", "Thin Film Thickness"),
    _ANISOTROPIC,
    _Part("rough diffuse light", "Diffuse Roughness", under="dielectric"),
    _Part("tint of the specular highlights", "Specular Tint", _WHITE),
    _Part("tint of the coat", "Coat Tint", _WHITE, under="coat"),
)
# Anisotropy that is no texture is carried by the BSDF itself, but not by other closures.
_NOT_BY_CLOSURES = " for light that the layers scatter, and below interfaces"
_UNDER = {"ior": "dielectric", "specular": "dielectric", "coat_roughness": "coat", "coat_ior": "coat"}


def find(material):
    """The Principled BSDF that feeds the Surface of the output that Cycles renders, through reroutes at most,
    or None."""
    return of(shown(material))


def shown(material):
    """The output socket of the shader that Cycles renders, behind reroutes, or None."""
    if material.node_tree is None or not node_tree.is_on(material):
        return None
    output = material.node_tree.get_output_node("CYCLES")
    return None if output is None else links.source(output.inputs["Surface"])


def of(shader):
    """The Principled BSDF with the output socket `shader`; None for None, other nodes, and muted ones."""
    is_principled = shader is not None and shader.node.type == "BSDF_PRINCIPLED" and not shader.node.mute
    return shader.node if is_principled else None


def values(node):
    """{quantity of PrincipledBase: value} of the node: numbers and, for the color, R, G, B. Values out of the
    quantity's range become the end of the range."""
    return {name: _clipped(name, node.inputs[socket].default_value) for name, socket in SOCKETS.items()}


def inputs(node):
    """The quantities that textures or animations set, among those that can be sockets of the node group."""
    return {name for name in INPUTS if _changes(node.inputs[SOCKETS[name]])}


def described(node):
    """Values and links of the sockets that layers take from the node, and its distribution, as text: equal
    texts have equal effects on the layers. Values that textures or animations set are left out."""
    found = [node.distribution]
    of_emission = (EMISSION, STRENGTH, COAT_NORMAL) if emits(node) else ()
    of_facets = (*ANISOTROPY, TANGENT) if _matters(node, ANISOTROPY[0], 0.0) else ()
    for name in (*SOCKETS.values(), NORMAL, ALPHA, *of_emission, *of_facets):
        socket = node.inputs[name]
        fed = links.feed(socket)
        by = None if fed is None else [fed.socket.node.name, fed.socket.identifier, fed.muted]
        is_set = socket.hide_value or _changes(socket)
        value = [] if is_set else _numbers(socket.default_value)
        found.append([by, socket_animation.is_animated(socket), value])
    return json.dumps(found)


def anisotropy(node):
    """The values of the sockets ANISOTROPY. All are 0 if a texture or an animation sets one of them."""
    sockets = [node.inputs[name] for name in ANISOTROPY]
    return [0.0 if any(map(_changes, sockets)) else socket.default_value for socket in sockets]


def has_tangent(node):
    """True if the node is anisotropic, as layers carry it, about a tangent that a link gives."""
    return anisotropy(node)[0] > 0.0 and links.source(node.inputs[TANGENT]) is not None


def emits(node):
    """True if the node may emit light."""
    return _matters(node, STRENGTH, 0.0) and _matters(node, EMISSION, _BLACK)


def is_coated(node):
    """True if the node may have a coat."""
    return _matters(node, COAT, 0.0)


def is_cut_out(node):
    """True if the node may be transparent by its alpha."""
    return _matters(node, ALPHA, 1.0)


def transmits(node):
    """True if light may pass the surface of the node."""
    weights = ("Transmission Weight", "Subsurface Weight")
    has_weight = any(_matters(node, name, 0.0) for name in weights)
    return is_cut_out(node) or (has_weight and _is_seen(node, "dielectric"))


def not_carried(node):
    """What layers over the node cannot carry or carry with a change: a list of short texts, without what has
    no effect on the picture."""
    texts = [part.words for part in _missing(node)]
    if anisotropy(node)[0] > 0.0:
        place = texts.index(_ANISOTROPIC.words)
        texts[place] += _NOT_BY_CLOSURES
    if is_coated(node) and links.source(node.inputs[COAT_NORMAL]) != links.source(node.inputs[NORMAL]):
        texts.append("normal of the coat (that of the surface is used)")
    for name, socket in SOCKETS.items():
        given, field = node.inputs[socket], _FIELDS[name]
        if not _is_seen(node, _UNDER.get(name, "")):
            continue
        if name not in INPUTS and _changes(given):
            what = "animation" if links.source(given) is None else "texture"
            texts.append(f"{what} of {socket} (the number {_words(values(node)[name])} is used instead)")
        elif not _changes(given) and _far(given.default_value, values(node)[name]):
            allowed = f"[{field.low:g}, {field.high:g}]"
            texts.append(f"{socket} {_words(given.default_value)} (must lie in {allowed})")
    if emits(node):
        texts.append("dimming of the emission (it shines above the layers)")
        if is_coated(node) and values(node)["coat_roughness"] > _SMOOTH_COAT:
            texts.append("roughness of the coat for the emission (a smooth coat dims it)")
    if node.distribution != "MULTI_GGX":
        texts.append("distribution GGX for light that the layers scatter (Multiscatter GGX is used)")
    return texts


def is_more_than_base(node):
    """True if the base lacks a part of the node without which the material is another one."""
    return any(part.is_large for part in _missing(node))


def _missing(node):
    return [part for part in _PARTS if _is_seen(node, part.under) and _matters(node, part.weight, part.none)]


def has_normals(nodes):
    """True if something feeds a normal of these nodes or of nodes in their groups, such as bump or a map."""
    sockets = [socket for node in nodes for socket in node.inputs if socket.name.endswith("Normal")]
    trees = [node.node_tree for node in nodes if node.type == "GROUP" and node.node_tree]
    return any(map(links.source, sockets)) or any(has_normals(tree.nodes) for tree in trees)


def _is_seen(node, under):
    """True if the part of the node that `under` names has any weight."""
    if under == "dielectric":
        return _matters(node, "Metallic", 1.0)
    return under != "coat" or is_coated(node)


def _changes(socket):
    """True if a texture or an animation sets the value of the socket."""
    return links.source(socket) is not None or socket_animation.is_animated(socket)


def _matters(node, name, none):
    """True if the socket may have another value than `none`, the one without effect."""
    socket = node.inputs.get(name)  # sockets differ between versions of Blender
    return socket is not None and (_changes(socket) or _far(socket.default_value, none))


def _far(one, other):
    one, other = _numbers(one), _numbers(other)
    return any(abs(a - b) > 1e-5 for a, b in zip(one, other, strict=True))


def _clipped(name, value):
    field = _FIELDS[name]
    low = field.low if field.panel.low is None else field.panel.low
    high = field.high if field.panel.high is None else field.panel.high
    clipped = tuple(min(max(number, low), high) for number in _numbers(value))
    return clipped if field.panel.rgb else clipped[0]


def _numbers(value):
    """One number as a tuple, and the first three of a color."""
    return tuple(value)[:3] if hasattr(value, "__len__") else (value,)


def _words(value):
    return ", ".join(f"{shortest(number):.4g}" for number in _numbers(value))
