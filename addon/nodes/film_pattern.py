# SPDX-License-Identifier: GPL-3.0-or-later
"""Drops, puddles and fingerprints: where a varying film lies, and how the surface of its liquid is tilted.

Node groups between the source of the film's coverage and the baked group. A point has the film or has none,
with a narrow edge between: Amount times the given coverage is the share of the surface with the film. All
settings are inputs of the group, so that the viewport follows them without a bake, and the file renders
without the add-on. The patterns lie over rest_coordinates.
"""

from math import cos, e, pi, radians
from typing import NamedTuple

from . import detail_group, rest_coordinates, table_view, texture_graph
from .graph import Graph
from .group_sockets import COVERAGE

NORMAL = "Normal"
_AMOUNT = "Share of the surface that has the film, where its coverage is 1"
_SPREAD = 0.22  # of Blender's fractal noise about its mean of 1/2; beyond this distance the noise is cut
_SMALL = 0.4  # size of the small drops, by that of the large ones
_DROP_EDGE = 0.1  # width of a drop's edge, by the drop's radius
_PUDDLE_EDGE = 0.05  # width of a puddle's edge, by the cut noise
# The cut noise is nearly normal; the logistic function approximates the normal distribution.
_LOGISTIC = 0.24
_LEAST = 1e-4  # share below which there is no puddle: the cut noise never reaches its threshold
_RIDGES = 32.0  # in the length of a fingerprint


class Pattern(NamedTuple):
    """A kind of pattern.

    settings: of detail_group.add_settings. draw(graph, inputs, place, normal, share): draws the nodes, and
    returns the sockets of the coverage and of the normal; the second is None if the film follows the
    surface."""

    mark: str
    version: int
    name: str
    settings: tuple
    draw: callable

    @property
    def sizes(self):
        """{setting: metres} of the settings that are lengths."""
        return {name: default for name, subtype, default, *_ in self.settings if subtype == "DISTANCE"}

    def group(self):
        """The node group, made or drawn anew if the file has none of this version."""
        return detail_group.of(self.mark, self.version, f"Lamina {self.name}", self._draw)

    def _draw(self, tree):
        _add_sockets(tree)
        detail_group.add_settings(tree, self.settings)
        graph = Graph(tree)
        inputs, outputs = graph.node("NodeGroupInput", 0, 0), graph.node("NodeGroupOutput", 16, 0)
        geometry = graph.node("ShaderNodeNewGeometry", 0, 10)
        normal = table_view.normal_of(graph, inputs.outputs[NORMAL], geometry.outputs["Normal"])
        place = rest_coordinates.draw(graph, 0, 14)
        given = graph.math("ADD", 3, 3, "coverage", inputs.outputs[COVERAGE], 0.0, clamp=True)
        share = graph.math("MULTIPLY", 4, 3, "share", given, inputs.outputs["Amount"], clamp=True)
        coverage, tilted = self.draw(graph, inputs, place, normal, share)
        graph.link(coverage, outputs.inputs[COVERAGE])
        graph.link(normal if tilted is None else tilted, outputs.inputs[NORMAL])


def _add_sockets(tree):
    share = {"subtype": "FACTOR", "default_value": 1.0, "min_value": 0.0, "max_value": 1.0}
    detail_group.add_input(tree, COVERAGE, "NodeSocketFloat", **share)
    detail_group.add_input(tree, NORMAL, "NodeSocketVector", hide_value=True)
    detail_group.add_output(tree, COVERAGE, "NodeSocketFloat")
    detail_group.add_output(tree, NORMAL, "NodeSocketVector")


def _drops(graph, inputs, place, normal, share):
    """Caps over balls about random points: a Boolean model. Large and small drops have equal shares."""
    size = inputs.outputs["Drop Size"]
    bare = graph.math("SUBTRACT", 5, 3, "1 - share", 1.0, graph.math("MINIMUM", 4.6, 3, "", share, 0.999))
    # Balls of the radius r about n points in a unit of volume leave the share exp(-4 pi r^3 n / 3).
    log = graph.math("LOGARITHM", 6, 3, "log", bare, e)
    cube = graph.math("MULTIPLY", 7, 3, "r^3", log, -0.5 * 3.0 / (4.0 * pi))
    radius = graph.math("POWER", 8, 3, "r", graph.math("MAXIMUM", 7.5, 3, "", cube, 0.0), 1.0 / 3.0)
    masks, heights = [], []
    for row, part in ((5, 1.0), (12, _SMALL)):
        cell = graph.math("MULTIPLY", 4, row, "cell", size, part)
        scale = graph.math("DIVIDE", 5, row, "per unit", 1.0, cell)
        points = texture_graph.points(graph, 6, row, place, scale)
        above = graph.math("SUBTRACT", 9, row, "r - d", radius, points.outputs["Distance"])
        edge = graph.math("MULTIPLY_ADD", 9, row + 1, "edge", radius, _DROP_EDGE, 1e-6)
        masks.append(graph.math("DIVIDE", 10, row, "drop", above, edge, clamp=True))
        # The cap (r^2 - d^2) / r, which meets the surface at a slope of twice the height.
        both = graph.math("ADD", 9, row + 2, "r + d", radius, points.outputs["Distance"])
        inside = graph.math("MAXIMUM", 9.6, row + 1, "", above, 0.0)
        cap = graph.math("MULTIPLY", 10, row + 1, "r^2 - d^2", inside, both)
        cap = graph.math("DIVIDE", 11, row + 1, "cap", cap, graph.math("ADD", 10, row + 2, "", radius, 1e-6))
        heights.append(graph.math("MULTIPLY", 12, row + 1, "height", cap, cell))
    highest = graph.math("MAXIMUM", 13, 6, "highest", *heights)
    height = graph.math("MULTIPLY", 14, 6, "height", highest, inputs.outputs["Height"])
    return graph.math("MAXIMUM", 13, 5, "drops", *masks), _bump(graph, 15, 6, height, normal)


def _puddles(graph, inputs, place, normal, share):
    """Noise above a threshold, on places that are nearly level; water is level."""
    scale = graph.math("DIVIDE", 3, 8, "per unit", 1.0, inputs.outputs["Puddle Size"])
    noise = _noise(graph, 4, 8, place, scale, 3.0)
    value = texture_graph.ramp(graph, 5, 8, "in [-1, 1]", noise, 0.5 - _SPREAD, 0.5 + _SPREAD)
    least = graph.math("COSINE", 4, 12, "least cosine", inputs.outputs["Steepest"])
    upright = graph.vector("DOT_PRODUCT", 4, 11, "cosine of the slope", normal, (0.0, 0.0, 1.0))
    above = graph.math("SUBTRACT", 5, 11, "above", upright, least)
    level = graph.math("DIVIDE", 6, 11, "level", above, 1.0 - cos(radians(5.0)), clamp=True)
    share = graph.math("MULTIPLY", 7, 3, "share of level places", share, level)
    share = graph.math("MINIMUM", 8, 3, "", graph.math("MAXIMUM", 7.5, 3, "", share, _LEAST), 1.0 - _LEAST)
    odds = graph.math("DIVIDE", 9, 3, "odds", share, graph.math("SUBTRACT", 8, 4, "1 - share", 1.0, share))
    log = graph.math("LOGARITHM", 10, 3, "log", odds, e)
    depth = graph.math("MULTIPLY_ADD", 11, 3, "depth", log, _LOGISTIC, value)
    edge = graph.math("MULTIPLY_ADD", 12, 3, "edge", depth, 1.0 / _PUDDLE_EDGE, 0.5, clamp=True)
    tilted = graph.mix("VECTOR", 13, 5, "level water", edge, normal, (0.0, 0.0, 1.0))
    return edge, graph.vector("NORMALIZE", 14, 5, "N", tilted)


def _prints(graph, inputs, place, normal, share):
    """Ridges in an ellipse about a random point, turned at random in the plane of the surface."""
    size = inputs.outputs["Print Size"]
    cell = graph.math("MULTIPLY", 4, 5, "cell", size, 1.4)
    points = texture_graph.points(graph, 6, 5, place, graph.math("DIVIDE", 5, 5, "per unit", 1.0, cell))
    local = graph.vector("SUBTRACT", 7, 5, "from the point", place, points.outputs["Position"])
    local = graph.scale(7.5, 6, "in sizes", local, graph.math("DIVIDE", 5, 6, "", 1.0, size))
    turned = graph.vector("SUBTRACT", 7, 8, "random axis", points.outputs["Color"], (0.5, 0.5, 0.5))
    along = graph.vector("NORMALIZE", 8, 8, "u", graph.vector("CROSS_PRODUCT", 7.5, 8, "", normal, turned))
    across = graph.vector("CROSS_PRODUCT", 8, 9, "v", normal, along)
    x = graph.vector("DOT_PRODUCT", 9, 8, "x", local, along)
    y = graph.vector("DOT_PRODUCT", 9, 9, "y", local, across)
    wide = _length(graph, 10, 5, graph.math("MULTIPLY", 9.6, 5, "", x, 1.4), y)
    inside = texture_graph.ramp(graph, 11, 5, "inside", wide, 0.5, 0.4, 0.0)
    bent = _noise(graph, 4, 12, place, graph.math("DIVIDE", 3, 12, "per unit", 2.5, size), 1.0)
    core = _length(graph, 10, 9, x, graph.math("ADD", 9.6, 9, "", y, 0.12))
    phase = graph.math("MULTIPLY_ADD", 11, 9, "", bent, 0.35, core)
    wave = graph.math("SINE", 12, 9, "ridges", graph.math("MULTIPLY", 11.6, 9, "", phase, 2.0 * pi * _RIDGES))
    ridges = graph.math("MULTIPLY_ADD", 13, 9, "ridges", wave, 2.0, 0.6, clamp=True)
    pores = _noise(graph, 4, 14, place, graph.math("DIVIDE", 3, 14, "per unit", 12.0, size), 2.0)
    pressed = texture_graph.ramp(graph, 5, 14, "pressed", pores, 0.4, 0.5, 0.0)
    chance = texture_graph.parts(graph, 8, 3, points.outputs["Color"])[0]
    is_there = graph.math("LESS_THAN", 9, 3, "is there", chance, share)
    there = graph.math("MULTIPLY", 12, 4, "in the ellipse", is_there, inside)
    there = graph.math("MULTIPLY", 13, 4, "pressed", there, pressed)
    return graph.math("MULTIPLY", 14, 4, "print", there, ridges), None


def _noise(graph, column, row, place, scale, detail):
    return texture_graph.noise(graph, column, row, "noise", place, scale, detail).outputs[0]


def _length(graph, column, row, x, y):
    square = graph.math("MULTIPLY", column, row, "", x, x)
    both = graph.math("MULTIPLY_ADD", column + 0.3, row, "", y, y, square)
    return graph.math("SQRT", column + 0.6, row, "distance", both)


def _bump(graph, column, row, height, normal):
    node = graph.node("ShaderNodeBump", column, row, "tilted")
    node.inputs["Strength"].default_value = node.inputs["Distance"].default_value = 1.0
    graph.link(height, node.inputs["Height"])
    graph.link(normal, node.inputs["Normal"])
    return node.outputs[0]


def _amount(default, description=_AMOUNT):
    return ("Amount", "FACTOR", default, 0.0, 1.0, description)


def _size(name, default, description):
    return (name, "DISTANCE", default, 1e-6, 1e4, description)


PATTERNS = {
    "DROPS": Pattern("lamina_drops", 1, "Drops", (
        _amount(0.35),
        _size("Drop Size", 0.006, "Distance between large drops, in the world"),
        ("Height", "FACTOR", 0.35, 0.0, 1.0, "Half the slope of a drop at its edge; 0 is flat"),
    ), _drops),
    "PUDDLES": Pattern("lamina_puddles", 1, "Puddles", (
        _amount(0.4),
        _size("Puddle Size", 0.3, "Size of the puddles in the world"),
        ("Steepest", "ANGLE", radians(12.0), 0.0, 0.5 * pi, "Slope from which no water stays"),
    ), _puddles),
    "PRINTS": Pattern("lamina_prints", 1, "Fingerprints", (
        _amount(0.4, "Share of random places that have a print, where the film's coverage is 1"),
        _size("Print Size", 0.018, "Length of a fingerprint in the world"),
    ), _prints),
}


def kind_of(node):
    """The key of PATTERNS whose group a node uses, or ""."""
    tree = node.node_tree if node.type == "GROUP" else None
    return next((kind for kind, one in PATTERNS.items() if tree is not None and one.mark in tree), "")
