# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of an object's interior: images over a UV map, as Subsurface Scattering or as emitted light."""

import numpy as np

from ..base import data_image
from . import boundary_graph, relightable_graph


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
    view = _view(graph) if by_view else None
    changes = [*images.lamp_changes, images.sky_change] if by_view else [None] * len(sources)
    every = zip(sources, [*images.lamps, images.sky], changes, strict=True)
    for row, (one, image, change) in enumerate(every):
        texels = textures.socket(one.name, one.factor * image, 3 * row)
        if change is not None:
            linear = textures.node(f"{one.name} by view", one.factor * change * [*scale, 1.0], 3 * row + 1)
            texels = _towards(graph, texels, linear, view, one.name, 3 * row)
        coloured = graph.vector("MULTIPLY", 3, 3 * row, one.name, texels, sockets[_colour(one)])
        light = graph.scale(3, 3 * row + 1, one.name, coloured, sockets[_strength(one)])
        total = light if total is None else graph.vector("ADD", 4, 3 * row, "all light", total, light)
    mirrored = None if surface.ior == 1.0 else boundary_graph.reflectance(graph, surface.ior)
    if by_view and surface.is_smooth:
        passed = graph.math("SUBTRACT", 4, -3, "1 - reflectance", 1.0, mirrored)
        total = graph.scale(4, -1, "light that the boundary lets out", total, passed)
    emission = graph.node("ShaderNodeEmission", 5, 0, "light from inside")
    graph.link(total, emission.inputs["Color"])
    if mirrored is None:
        return emission.outputs[0], None
    return boundary_graph.beside(graph, mirrored, surface.alpha, emission.outputs[0]), None


def _view(graph):
    """The socket of the direction to the eye in the object's own space, where lengths are divided by the
    object's scale."""
    geometry = graph.node("ShaderNodeNewGeometry", -3, 5, "view")
    turned = graph.node("ShaderNodeVectorTransform", -2, 5, "view in the object's space")
    turned.vector_type, turned.convert_from, turned.convert_to = "VECTOR", "WORLD", "OBJECT"
    graph.link(geometry.outputs["Incoming"], turned.inputs["Vector"])
    return turned.outputs["Vector"]


def _towards(graph, light, change, view, name, row):
    """The socket of light whose mean over channels is max(0, b . view + c). `change`: the node of (b, c)."""
    along = graph.vector("DOT_PRODUCT", -1, row + 1, f"{name} b . view", change.outputs["Color"], view)
    linear = graph.math("ADD", 0, row + 1, f"{name} b . view + c", along, change.outputs["Alpha"])
    wanted = graph.math("MAXIMUM", 1, row + 1, f"{name} towards the eye", linear, 0.0)
    mean = graph.vector("DOT_PRODUCT", -1, row, f"{name} mean", light, (1.0 / 3.0,) * 3)
    share = graph.math("DIVIDE", 1, row, f"{name} / mean", wanted, mean)  # 0 where the mean is 0
    return graph.scale(2, row, f"{name} towards the eye", light, share)


def _strength(source):
    return f"{source.name} Strength"


def _colour(source):
    return f"{source.name} Color"


class _Images:
    """Image textures over one UV map."""

    def __init__(self, graph, uv_map, name):
        self._graph, self._name = graph, name
        self._map = graph.node("ShaderNodeUVMap", -3, 3, "texels")
        self._map.uv_map = uv_map

    def socket(self, what, pixels, row):
        """Add an image of (height, width, 3), bottom row first; the socket of its colour."""
        texels = np.ones((*pixels.shape[:2], 4), np.float32)
        texels[..., :3] = pixels
        return self.node(what, texels, row).outputs["Color"]

    def node(self, what, texels, row):
        """Add an image of (height, width, 4), bottom row first; its node."""
        node = self._graph.node("ShaderNodeTexImage", -2, row, what)
        node.image = data_image.create(f"Lamina {self._name} {what}", texels)
        node.interpolation, node.extension = "Linear", "EXTEND"
        self._graph.link(self._map.outputs["UV"], node.inputs["Vector"])
        return node
