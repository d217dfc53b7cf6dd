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
        inputs, outputs = graph.node("NodeGroupInput"), graph.node("NodeGroupOutput")
        geometry = graph.node("ShaderNodeNewGeometry")
        normal = table_view.normal_of(graph, inputs.outputs[NORMAL], geometry.outputs["Normal"])
        place = rest_coordinates.draw(graph)
        given = graph.math("ADD", "coverage", inputs.outputs[COVERAGE], 0.0, clamp=True)
        share = graph.math("MULTIPLY", "share", given, inputs.outputs["Amount"], clamp=True)
        coverage, tilted = self.draw(graph, inputs, place, normal, share)
        graph.link(coverage, outputs.inputs[COVERAGE])
        graph.link(normal if tilted is None else tilted, outputs.inputs[NORMAL])
        graph.arrange()


def _add_sockets(tree):
    share = {"subtype": "FACTOR", "default_value": 1.0, "min_value": 0.0, "max_value": 1.0}
    detail_group.add_input(tree, COVERAGE, "NodeSocketFloat", **share)
    detail_group.add_input(tree, NORMAL, "NodeSocketVector", hide_value=True)
    detail_group.add_output(tree, COVERAGE, "NodeSocketFloat")
    detail_group.add_output(tree, NORMAL, "NodeSocketVector")


def _drops(graph, inputs, place, normal, share):
    """Caps over balls about random points: a Boolean model. Large and small drops have equal shares."""
    size = inputs.outputs["Drop Size"]
    bare = graph.math("SUBTRACT", "1 - share", 1.0, graph.math("MINIMUM", "", share, 0.999))
    # Balls of the radius r about n points in a unit of volume leave the share exp(-4 pi r^3 n / 3).
    log = graph.math("LOGARITHM", "log", bare, e)
    cube = graph.math("MULTIPLY", "r^3", log, -0.5 * 3.0 / (4.0 * pi))
    radius = graph.math("POWER", "r", graph.math("MAXIMUM", "", cube, 0.0), 1.0 / 3.0)
    masks, heights = [], []
    for part in (1.0, _SMALL):
        cell = graph.math("MULTIPLY", "cell", size, part)
        scale = graph.math("DIVIDE", "per unit", 1.0, cell)
        points = texture_graph.points(graph, place, scale)
        above = graph.math("SUBTRACT", "r - d", radius, points.outputs["Distance"])
        edge = graph.math("MULTIPLY_ADD", "edge", radius, _DROP_EDGE, 1e-6)
        masks.append(graph.math("DIVIDE", "drop", above, edge, clamp=True))
        # The cap (r^2 - d^2) / r, which meets the surface at a slope of twice the height.
        both = graph.math("ADD", "r + d", radius, points.outputs["Distance"])
        inside = graph.math("MAXIMUM", "", above, 0.0)
        cap = graph.math("MULTIPLY", "r^2 - d^2", inside, both)
        cap = graph.math("DIVIDE", "cap", cap, graph.math("ADD", "", radius, 1e-6))
        heights.append(graph.math("MULTIPLY", "height", cap, cell))
    highest = graph.math("MAXIMUM", "highest", *heights)
    height = graph.math("MULTIPLY", "height", highest, inputs.outputs["Height"])
    return graph.math("MAXIMUM", "drops", *masks), _bump(graph, height, normal)


def _puddles(graph, inputs, place, normal, share):
    """Noise above a threshold, on places that are nearly level; water is level."""
    scale = graph.math("DIVIDE", "per unit", 1.0, inputs.outputs["Puddle Size"])
    noise = _noise(graph, place, scale, 3.0)
    value = texture_graph.ramp(graph, "in [-1, 1]", noise, 0.5 - _SPREAD, 0.5 + _SPREAD)
    least = graph.math("COSINE", "least cosine", inputs.outputs["Steepest"])
    upright = graph.vector("DOT_PRODUCT", "cosine of the slope", normal, (0.0, 0.0, 1.0))
    above = graph.math("SUBTRACT", "above", upright, least)
    level = graph.math("DIVIDE", "level", above, 1.0 - cos(radians(5.0)), clamp=True)
    share = graph.math("MULTIPLY", "share of level places", share, level)
    share = graph.math("MINIMUM", "", graph.math("MAXIMUM", "", share, _LEAST), 1.0 - _LEAST)
    odds = graph.math("DIVIDE", "odds", share, graph.math("SUBTRACT", "1 - share", 1.0, share))
    log = graph.math("LOGARITHM", "log", odds, e)
    depth = graph.math("MULTIPLY_ADD", "depth", log, _LOGISTIC, value)
    edge = graph.math("MULTIPLY_ADD", "edge", depth, 1.0 / _PUDDLE_EDGE, 0.5, clamp=True)
    tilted = graph.mix("VECTOR", "level water", edge, normal, (0.0, 0.0, 1.0))
    return edge, graph.vector("NORMALIZE", "N", tilted)


def _prints(graph, inputs, place, normal, share):
    """Ridges in an ellipse about a random point, turned at random in the plane of the surface."""
    size = inputs.outputs["Print Size"]
    cell = graph.math("MULTIPLY", "cell", size, 1.4)
    points = texture_graph.points(graph, place, graph.math("DIVIDE", "per unit", 1.0, cell))
    local = graph.vector("SUBTRACT", "from the point", place, points.outputs["Position"])
    local = graph.scale("in sizes", local, graph.math("DIVIDE", "", 1.0, size))
    turned = graph.vector("SUBTRACT", "random axis", points.outputs["Color"], (0.5, 0.5, 0.5))
    along = graph.vector("NORMALIZE", "u", graph.vector("CROSS_PRODUCT", "", normal, turned))
    across = graph.vector("CROSS_PRODUCT", "v", normal, along)
    x = graph.vector("DOT_PRODUCT", "x", local, along)
    y = graph.vector("DOT_PRODUCT", "y", local, across)
    wide = _length(graph, graph.math("MULTIPLY", "", x, 1.4), y)
    inside = texture_graph.ramp(graph, "inside", wide, 0.5, 0.4, 0.0)
    bent = _noise(graph, place, graph.math("DIVIDE", "per unit", 2.5, size), 1.0)
    core = _length(graph, x, graph.math("ADD", "", y, 0.12))
    phase = graph.math("MULTIPLY_ADD", "", bent, 0.35, core)
    wave = graph.math("SINE", "ridges", graph.math("MULTIPLY", "", phase, 2.0 * pi * _RIDGES))
    ridges = graph.math("MULTIPLY_ADD", "ridges", wave, 2.0, 0.6, clamp=True)
    pores = _noise(graph, place, graph.math("DIVIDE", "per unit", 12.0, size), 2.0)
    pressed = texture_graph.ramp(graph, "pressed", pores, 0.4, 0.5, 0.0)
    chance = texture_graph.parts(graph, points.outputs["Color"])[0]
    is_there = graph.math("LESS_THAN", "is there", chance, share)
    there = graph.math("MULTIPLY", "in the ellipse", is_there, inside)
    there = graph.math("MULTIPLY", "pressed", there, pressed)
    return graph.math("MULTIPLY", "print", there, ridges), None


def _noise(graph, place, scale, detail):
    return texture_graph.noise(graph, "noise", place, scale, detail).outputs[0]


def _length(graph, x, y):
    square = graph.math("MULTIPLY", "", x, x)
    both = graph.math("MULTIPLY_ADD", "", y, y, square)
    return graph.math("SQRT", "distance", both)


def _bump(graph, height, normal):
    node = graph.node("ShaderNodeBump", "tilted")
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
