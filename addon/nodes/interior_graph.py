# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of an object's interior: images over a UV map, as Subsurface Scattering or as emitted light."""

import math
from collections import namedtuple

import numpy as np

from ..base import data_image
from . import boundary_graph, relightable_graph

# The largest light in a direction, over the mean. A texel of a curved surface is also seen from below its
# tangent plane, where its exponential is not fitted.
LARGEST = 5.0

# Sockets of the direction to the eye in the object's own axes, of (xy, yz, zx), and of two squares.
_View = namedtuple("_View", ("direction", "products", "xx", "yy"))


def draw_relightable(graph, inputs, length, uv_map, name):
    """Add the nodes and return (the shader's socket, None): there is no volume.

    `inputs`: lamina.SubsurfaceInputs with images in millimetres; `length`: the socket with the number of
    Blender units per millimetre; `name`: of the material."""
    images = _Images(graph, uv_map, name)
    return relightable_graph.draw(graph, inputs, length, images.socket)


def lit_inputs(sources):
    """Inputs of the group for lateral_group.build: strength and colour of each source."""
    found = []
    for one in sources:
        what = f"of {one.name}, at first that of the scene"
        found.append((_strength(one), "NodeSocketFloat", one.strength, f"Strength {what}"))
        found.append((_colour(one), "NodeSocketColor", (*one.colour, 1.0), f"Color {what}"))
    return found


def draw_lit(graph, images, sources, surface, uv_map, name, scale, sockets):
    """Add the nodes and return (the shader's socket, None): there is no volume.

    `images`: lamina.LitImages for the sources in sequence, lamps first, the world last; `sockets`: inputs of
    the group by name; `name`: of the material; `scale`: (3,), of the object. The surface emits the sum, and
    no closure but the boundary's mirror receives light, so that nothing is lit twice."""
    textures, total = _Images(graph, uv_map, name), None
    by_view = images.sky_change is not None
    view = _view(graph, scale) if by_view else None
    changes = [*images.lamp_changes, images.sky_change] if by_view else [None] * len(sources)
    every = zip(sources, [*images.lamps, images.sky], changes, strict=True)
    for one, image, change in every:
        if change is None:
            light = textures.socket(one.name, one.factor * image)
        else:
            light = _towards(graph, textures, one.name, one.factor * image, change, view)
        coloured = graph.vector("MULTIPLY", one.name, light, sockets[_colour(one)])
        shown = graph.scale(one.name, coloured, sockets[_strength(one)])
        total = shown if total is None else graph.vector("ADD", "all light", total, shown)
    mirrored = None if surface.ior == 1.0 else boundary_graph.reflectance(graph, surface.ior)
    if by_view and surface.is_smooth:
        passed = graph.math("SUBTRACT", "1 - reflectance", 1.0, mirrored)
        total = graph.scale("light that the boundary lets out", total, passed)
    emission = graph.node("ShaderNodeEmission", "light from inside")
    graph.link(total, emission.inputs["Color"])
    if mirrored is None:
        return emission.outputs[0], None
    return boundary_graph.beside(graph, mirrored, surface.alpha, emission.outputs[0]), None


def _view(graph, scale):
    geometry = graph.node("ShaderNodeNewGeometry", "view")
    turned = graph.node("ShaderNodeVectorTransform", "view in the object's space")
    turned.vector_type, turned.convert_from, turned.convert_to = "VECTOR", "WORLD", "OBJECT"
    graph.link(geometry.outputs["Incoming"], turned.inputs["Vector"])
    # In the object's space lengths are divided by its scale.
    direction = graph.vector("MULTIPLY", "view", turned.outputs["Vector"], tuple(scale))
    x, y, z = graph.separate("view", direction)
    others = graph.node("ShaderNodeCombineColor", "y, z, x")
    for value, socket in zip((y, z, x), others.inputs, strict=True):
        graph.link(value, socket)
    products = graph.vector("MULTIPLY", "xy, yz, zx", direction, others.outputs["Color"])
    squares = [graph.math("MULTIPLY", name, value, value) for name, value in (("xx", x), ("yy", y))]
    return _View(direction, products, *squares)


def _towards(graph, textures, name, image, change, view):
    """The socket of light times the exponential of a quadratic function of the view. `change`: the factors of
    x, y, z, xx, yy, xy, yz, zx, and of 1, see lamina.LitImages."""
    light = textures.node(name, np.concatenate([image, change[..., 8:]], axis=-1))
    linear = textures.node(f"{name} by view", change[..., :4])
    square = textures.node(f"{name} by view squared", change[..., [5, 6, 7, 4]])
    exponent = light.outputs["Alpha"]
    for node, vector, number in ((linear, view.direction, view.xx), (square, view.products, view.yy)):
        term = graph.vector("DOT_PRODUCT", node.label, node.outputs["Color"], vector)
        term = graph.math("MULTIPLY_ADD", node.label, node.outputs["Alpha"], number, term)
        exponent = graph.math("ADD", f"{name} exponent", exponent, term)
    exponent = graph.math("MINIMUM", f"{name} exponent", exponent, math.log(LARGEST))
    factor = graph.math("EXPONENT", f"{name} towards the eye", exponent)
    return graph.scale(f"{name} towards the eye", light.outputs["Color"], factor)


def _strength(source):
    return f"{source.name} Strength"


def _colour(source):
    return f"{source.name} Color"


class _Images:
    """Image textures over one UV map."""

    def __init__(self, graph, uv_map, name):
        self._graph, self._name = graph, name
        self._map = graph.node("ShaderNodeUVMap", "texels")
        self._map.uv_map = uv_map

    def socket(self, what, pixels):
        """Add an image of (height, width, 3), bottom row first; the socket of its colour."""
        texels = np.ones((*pixels.shape[:2], 4), np.float32)
        texels[..., :3] = pixels
        return self.node(what, texels).outputs["Color"]

    def node(self, what, texels):
        """Add an image of (height, width, 4), bottom row first; its node."""
        node = self._graph.node("ShaderNodeTexImage", what)
        node.image = data_image.create(f"Lamina {self._name} {what}", texels)
        node.interpolation, node.extension = "Linear", "EXTEND"
        self._graph.link(self._map.outputs["UV"], node.inputs["Vector"])
        return node
