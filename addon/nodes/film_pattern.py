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
from .expression import clamped, cosine, cross, dot, logarithm, maximum, minimum, normalized, sine, sqrt
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

    settings: of detail_group.add_settings. draw(graph, inputs, place, normal, share): the coverage and the
    normal; the second is None if the film follows the surface."""

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
        inputs, outputs = graph.values(graph.node("NodeGroupInput")), graph.node("NodeGroupOutput")
        geometry = graph.values(graph.node("ShaderNodeNewGeometry"))
        normal = table_view.normal_of(graph, inputs[NORMAL], geometry["Normal"])
        place = rest_coordinates.draw(graph)
        share = clamped(clamped(inputs[COVERAGE]) * inputs["Amount"]).named("share")
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
    # Balls of the radius r about n points in a unit of volume leave the share exp(-4 pi r^3 n / 3).
    log = logarithm(1.0 - minimum(share, 0.999), e)
    radius = (maximum(log * (-0.5 * 3.0 / (4.0 * pi)), 0.0) ** (1.0 / 3.0)).named("r")
    masks, heights = [], []
    for part in (1.0, _SMALL):
        cell = inputs["Drop Size"] * part
        away = graph.values(texture_graph.points(graph, place, 1.0 / cell))["Distance"]
        above = radius - away
        masks.append(clamped(above / (radius * _DROP_EDGE + 1e-6)).named("drop"))
        # The cap (r^2 - d^2) / r, which meets the surface at a slope of twice the height.
        heights.append((maximum(above, 0.0) * (radius + away) / (radius + 1e-6) * cell).named("cap"))
    height = maximum(*heights) * inputs["Height"]
    return maximum(*masks).named("drops"), _bump(graph, height, normal)


def _puddles(graph, inputs, place, normal, share):
    """Noise above a threshold, on places that are nearly level; water is level."""
    noise = _noise(graph, place, 1.0 / inputs["Puddle Size"], 3.0)
    value = texture_graph.ramp(graph, "in [-1, 1]", noise, 0.5 - _SPREAD, 0.5 + _SPREAD)
    above = dot(normal, (0.0, 0.0, 1.0)) - cosine(inputs["Steepest"])
    level = clamped(above / (1.0 - cos(radians(5.0)))).named("level")
    share = minimum(maximum(share * level, _LEAST), 1.0 - _LEAST).named("share of level places")
    depth = logarithm(share / (1.0 - share), e) * _LOGISTIC + value
    edge = clamped(depth * (1.0 / _PUDDLE_EDGE) + 0.5).named("edge")
    return edge, normalized(graph.mix("VECTOR", "level water", edge, normal, (0.0, 0.0, 1.0)))


def _prints(graph, inputs, place, normal, share):
    """Ridges in an ellipse about a random point, turned at random in the plane of the surface."""
    size = inputs["Print Size"]
    points = graph.values(texture_graph.points(graph, place, 1.0 / (size * 1.4)))
    local = (place - points["Position"]) / size
    along = normalized(cross(normal, points["Color"] - (0.5, 0.5, 0.5)))
    x = dot(local, along).named("x")
    y = dot(local, cross(normal, along)).named("y")
    inside = texture_graph.ramp(graph, "inside", _length(x * 1.4, y), 0.5, 0.4, 0.0)
    bent = _noise(graph, place, 2.5 / size, 1.0)
    phase = bent * 0.35 + _length(x, y + 0.12)
    ridges = clamped(sine(phase * (2.0 * pi * _RIDGES)) * 2.0 + 0.6).named("ridges")
    pores = _noise(graph, place, 12.0 / size, 2.0)
    pressed = texture_graph.ramp(graph, "pressed", pores, 0.4, 0.5, 0.0)
    is_there = texture_graph.parts(graph, points["Color"])[0] < share
    return (is_there * inside * pressed * ridges).named("print"), None


def _noise(graph, place, scale, detail):
    return graph.value(texture_graph.noise(graph, "noise", place, scale, detail).outputs[0])


def _length(x, y):
    return sqrt(x**2 + y**2)


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
