# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of an object's interior: images over a UV map, as Subsurface Scattering or as emitted light."""

import math
from collections import namedtuple

import numpy as np

from ..base import data_image
from . import boundary_graph, relightable_graph
from .expression import dot, exponential, minimum

# The largest light in a direction, over the mean. A texel of a curved surface is also seen from below its
# tangent plane, where its exponential is not fitted.
LARGEST = 5.0

# The direction to the eye in the object's own axes, of (xy, yz, zx), and of two squares.
_View = namedtuple("_View", ("direction", "products", "xx", "yy"))


def draw_relightable(graph, inputs, length, uv_map, name):
    """Add the nodes and return (the shader's socket, None): there is no volume.

    `inputs`: lamina.SubsurfaceInputs with images in millimetres; `length`: the number of Blender units
    per millimetre, a socket; `name`: of the material."""
    images = _Images(graph, uv_map, name)
    return relightable_graph.draw(graph, inputs, length, images.color)


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

    `images`: lamina.LitImages for the sources in sequence, lamps first, the world last; `sockets`: inputs
    of the group by name; `name`: of the material; `scale`: (3,), of the object. The surface emits the sum,
    and no closure but the boundary's mirror receives light, so that nothing is lit twice."""
    textures, total = _Images(graph, uv_map, name), 0.0
    by_view = images.sky_change is not None
    view = _view(graph, scale) if by_view else None
    changes = [*images.lamp_changes, images.sky_change] if by_view else [None] * len(sources)
    every = zip(sources, [*images.lamps, images.sky], changes, strict=True)
    for one, image, change in every:
        if change is None:
            light = textures.color(one.name, one.factor * image)
        else:
            light = _towards(textures, one.name, one.factor * image, change, view)
        colour, strength = graph.value(sockets[_colour(one)]), graph.value(sockets[_strength(one)])
        total += (light * colour * strength).named(one.name)
    mirrored = None if surface.ior == 1.0 else boundary_graph.reflectance(graph, surface.ior)
    if by_view and surface.is_smooth:
        total = (total * (1.0 - mirrored)).named("light that the boundary lets out")
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
    direction = (graph.value(turned.outputs["Vector"]) * tuple(scale)).named("view")
    x, y, z = graph.separate("view", direction)
    others = graph.node("ShaderNodeCombineColor", "y, z, x")
    for value, socket in zip((y, z, x), others.inputs, strict=True):
        graph.link(value, socket)
    products = direction * graph.value(others.outputs["Color"])
    return _View(direction, products.named("xy, yz, zx"), (x**2).named("xx"), (y**2).named("yy"))


def _towards(textures, name, image, change, view):
    """Light times the exponential of a quadratic function of the view. `change`: the factors of
    x, y, z, xx, yy, xy, yz, zx, and of 1, see lamina.LitImages."""
    light = textures.values(name, np.concatenate([image, change[..., 8:]], axis=-1))
    linear = textures.values(f"{name} by view", change[..., :4])
    square = textures.values(f"{name} by view squared", change[..., [5, 6, 7, 4]])
    exponent = light["Alpha"] + linear["Alpha"] * view.xx + square["Alpha"] * view.yy
    exponent += dot(linear["Color"], view.direction) + dot(square["Color"], view.products)
    factor = exponential(minimum(exponent, math.log(LARGEST)))
    return (light["Color"] * factor).named(f"{name} towards the eye")


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

    def color(self, what, pixels):
        """Add an image of (height, width, 3), bottom row first; its colour."""
        texels = np.ones((*pixels.shape[:2], 4), np.float32)
        texels[..., :3] = pixels
        return self.values(what, texels)["Color"]

    def values(self, what, texels):
        """Add an image of (height, width, 4), bottom row first; its Color and Alpha by name."""
        node = self._graph.node("ShaderNodeTexImage", what)
        node.image = data_image.create(f"Lamina {self._name} {what}", texels)
        node.interpolation, node.extension = "Linear", "EXTEND"
        self._graph.link(self._map.outputs["UV"], node.inputs["Vector"])
        return self._graph.values(node)
