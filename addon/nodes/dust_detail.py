# SPDX-License-Identifier: GPL-3.0-or-later
"""Detail of a layer's thickness: clouds, grain, fibers and specks, and places that were wiped clean.

A node group between the source of the thickness T and the baked group gives
(T (1 + Clouds c) (1 + Grain g) + litter) (1 - Wiped), where c and g are noises with values in [-1, 1] and
mean 0: they keep the mean thickness over a surface. The litter is sparse and comes on top of this mean, see
dust_litter. All settings are inputs of the group, so that the viewport follows them without a bake, and the
file renders without the add-on. All detail lies over rest_coordinates. The strength of all dust
(dust_strength) is a factor as well.
"""

from . import detail_group, dust_litter, dust_strength, rest_coordinates, texture_graph
from .expression import clamped, dot, maximum, minimum
from .graph import Graph
from .side_graph import BACK, FRONT

NAME = "Lamina Dust Detail"
MARK = detail_group.MARKS[0]
HEIGHT = "Height"  # output: the thickness of the front without grain and litter
VERSION = 4
SETTLED = {"Clouds": 0.6, "Grain": 0.5}
# Of a layer that is even and as thick as baked: only the thin places of the noise are seen.
UNSETTLED = {"Clouds": 0.9, "Grain": 0.8}
SIZES = {"Cloud Size": 0.05, "Grain Size": 0.0015, **dust_litter.SIZES}  # in metres

# (name, subtype, default, least, most, description) of the settings.
SETTINGS = (
    ("Clouds", "FACTOR", SETTLED["Clouds"], 0.0, 1.0, "Strength of broad variation; the mean stays"),
    ("Cloud Size", "DISTANCE", SIZES["Cloud Size"], 1e-5, 1e4, "Size of the broad variation in the world"),
    ("Grain", "FACTOR", SETTLED["Grain"], 0.0, 1.0, "Strength of fine variation; the mean stays"),
    ("Grain Size", "DISTANCE", SIZES["Grain Size"], 1e-6, 1e4,
     "Size of coarse grains in the world; fine ones are a quarter"),
    *dust_litter.SETTINGS,
    ("Wiped", "FACTOR", 0.0, 0.0, 1.0, "Share of the layer that was wiped off"),
)

# Of each noise: octaves beyond the first, the ratio of their sizes and of their strengths, and the distance
# from the mean 1/2 where the noise is cut. Its distribution is symmetric, so that cuts keep the mean.
_NOISES = {"Clouds": (3.0, 2.0, 0.5, 0.22), "Grain": (1.0, 4.0, 1.0, 0.12)}

_AXES = ((0.36, 0.48, -0.8), (-0.8, 0.6, 0.0), (0.48, 0.64, 0.6))


def group():
    """The node group, made or drawn anew if the file has none of this version."""
    dust_strength.group()
    return detail_group.of(MARK, VERSION, NAME, _draw)


def remove_unused():
    """Remove the group if nothing uses it, and the strength of all dust."""
    detail_group.remove_unused()
    dust_strength.remove_unused()


def _add_sockets(tree):
    for name, default in ((FRONT, 0.0), (BACK, -1.0)):
        detail_group.add_input(tree, name, "NodeSocketFloat", default_value=default)
    for name in (FRONT, BACK, HEIGHT):
        detail_group.add_output(tree, name, "NodeSocketFloat")
    detail_group.add_settings(tree, SETTINGS)


def _draw(tree):
    _add_sockets(tree)
    graph = Graph(tree)
    inputs, outputs = graph.values(graph.node("NodeGroupInput")), graph.node("NodeGroupOutput")
    place = rest_coordinates.draw(graph)
    # The noise has edges along its axes, seen on faces across them.
    turned = graph.combined("turned", *(dot(place, axis) for axis in _AXES))
    clouds = _varied(graph, inputs, place, "Clouds", "Cloud Size")
    grain = _varied(graph, inputs, turned, "Grain", "Grain Size")
    litter = dust_litter.draw(graph, inputs, (place, turned), maximum(inputs[FRONT], inputs[BACK]))
    strength = graph.node("ShaderNodeGroup", "Strength")
    strength.node_tree = dust_strength.group()
    shown = (clamped(1.0 - inputs["Wiped"]) * graph.value(strength.outputs[0])).named("shown")
    varied = (clouds * grain).named("clouds and grain")

    def on_side(given):
        lies = clamped(given * (1.0 / dust_litter.LEAST)).named("litter lies here")
        return (lies * litter + given * varied) * shown

    # A negative thickness of the back stands for that of the front, and must stay negative.
    back = on_side(maximum(inputs[BACK], 0.0)) + minimum(inputs[BACK], 0.0)
    smooth = inputs[FRONT] * clouds * shown
    for name, value in ((HEIGHT, smooth), (FRONT, on_side(inputs[FRONT])), (BACK, back)):
        graph.link(value.named(name), outputs.inputs[name])
    graph.arrange()


def _varied(graph, inputs, place, strength, size):
    """1 + strength x noise."""
    octaves, finer, weaker, cut = _NOISES[strength]
    noise = texture_graph.noise(graph, strength, place, 1.0 / inputs[size], octaves)
    noise.inputs["Lacunarity"].default_value, noise.inputs["Roughness"].default_value = finer, weaker
    varied = texture_graph.ramp(graph, "in [-1, 1]", noise.outputs[0], 0.5 - cut, 0.5 + cut)
    return (varied * inputs[strength] + 1.0).named("1 + strength noise")
