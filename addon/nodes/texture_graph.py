# SPDX-License-Identifier: GPL-3.0-or-later
"""Texture nodes in three dimensions that patterns share: noise, random points, and their values."""


def noise(graph, label, place, scale, detail):
    """The node of a fractal noise. `detail`: octaves beyond the first."""
    node = graph.node("ShaderNodeTexNoise", label)
    node.noise_dimensions = "3D"
    graph.link(place, node.inputs["Vector"])
    graph.link(scale, node.inputs["Scale"])
    node.inputs["Detail"].default_value = detail
    return node


def points(graph, place, scale):
    """The node of a Voronoi pattern: Distance, Color and Position of the nearest random point."""
    node = graph.node("ShaderNodeTexVoronoi", "random points")
    node.voronoi_dimensions = "3D"
    graph.link(place, node.inputs["Vector"])
    graph.link(scale, node.inputs["Scale"])
    return node


def ramp(graph, label, value, first, last, start=-1.0):
    """`start` at `first` and before, 1 at `last` and beyond, linear between."""
    node = graph.node("ShaderNodeMapRange", label)
    node.clamp = True
    graph.link(value, node.inputs["Value"])
    for name, number in (("From Min", first), ("From Max", last), ("To Min", start), ("To Max", 1.0)):
        node.inputs[name].default_value = number
    return graph.value(node.outputs["Result"])


def parts(graph, vector):
    """The three parts of a vector or color."""
    node = graph.node("ShaderNodeSeparateXYZ", "parts")
    graph.link(vector, node.inputs[0])
    return [graph.value(socket) for socket in node.outputs]
