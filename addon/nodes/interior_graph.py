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


def draw_lit(graph, images, sources, surface, uv_map, name, sockets):
    """Add the nodes and return (the shader's socket, None): there is no volume.

    `images`: lamina.LitImages for the sources in sequence, lamps first, the world last; `sockets`: inputs of
    the group by name; `name`: of the material. The surface emits the sum, and no closure but the boundary's
    mirror receives light, so that nothing is lit twice."""
    textures, total = _Images(graph, uv_map, name), None
    for row, (one, image) in enumerate(zip(sources, [*images.lamps, images.sky], strict=True)):
        texels = textures.socket(one.name, one.factor * image, 2 * row)
        coloured = graph.vector("MULTIPLY", 0, 2 * row, one.name, texels, sockets[_colour(one)])
        light = graph.scale(1, 2 * row, one.name, coloured, sockets[_strength(one)])
        total = light if total is None else graph.vector("ADD", 2, 2 * row, "all light", total, light)
    emission = graph.node("ShaderNodeEmission", 4, 0, "light from inside")
    graph.link(total, emission.inputs["Color"])
    if surface.ior == 1.0:
        return emission.outputs[0], None
    return boundary_graph.beside(graph, surface.ior, surface.alpha, emission.outputs[0]), None


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
        node = self._graph.node("ShaderNodeTexImage", -2, row, what)
        node.image = data_image.create(f"Lamina {self._name} {what}", texels)
        node.interpolation, node.extension = "Linear", "EXTEND"
        self._graph.link(self._map.outputs["UV"], node.inputs["Vector"])
        return node.outputs["Color"]
