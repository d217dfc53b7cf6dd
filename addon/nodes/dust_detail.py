# SPDX-License-Identifier: GPL-3.0-or-later
"""Detail of a layer's thickness: clouds, grain, and places that were wiped clean.

A node group between the source of the thickness and the baked group multiplies the thickness by
(1 + Clouds c) (1 + Grain g) (1 - Wiped), where c and g are noises with values in [-1, 1] and mean 0: the mean
thickness over a surface is kept. All settings are inputs of the group, so that the viewport follows them
without a bake, and the file renders without the add-on. The noises lie over rest_coordinates. The strength of
all dust (dust_strength) is a factor as well.
"""

from . import detail_group, dust_strength, rest_coordinates
from .graph import Graph
from .side_graph import BACK, FRONT

NAME = "Lamina Dust Detail"
MARK = detail_group.MARKS[0]
VERSION = 3
CLOUDS, GRAIN = 0.6, 0.5
SIZES = {"Cloud Size": 0.05, "Grain Size": 0.0015}  # in metres

# (name, subtype, default, least, most, description) of the settings.
SETTINGS = (
    ("Clouds", "FACTOR", CLOUDS, 0.0, 1.0, "Strength of broad variation; the mean thickness stays"),
    ("Cloud Size", "DISTANCE", SIZES["Cloud Size"], 1e-5, 1e4, "Size of the broad variation in the world"),
    ("Grain", "FACTOR", GRAIN, 0.0, 1.0, "Strength of fine variation; the mean thickness stays"),
    ("Grain Size", "DISTANCE", SIZES["Grain Size"], 1e-6, 1e4, "Size of the fine variation in the world"),
    ("Wiped", "FACTOR", 0.0, 0.0, 1.0, "Share of the layer that was wiped off"),
)

# Blender's fractal noise has mean 1/2 and a symmetric distribution; beyond these distances from the mean the
# noise is cut.
_SPREAD = {"Clouds": 0.22, "Grain": 0.16}
_OCTAVES = {"Clouds": 3.0, "Grain": 1.0}


def group():
    """The node group, made or drawn anew if the file has none of this version."""
    return detail_group.of(MARK, VERSION, NAME, _draw)


def remove_unused():
    """Remove the group if nothing uses it, and the strength of all dust."""
    detail_group.remove_unused()
    dust_strength.remove_unused()


def _add_sockets(tree):
    have = {(item.name, item.in_out) for item in tree.interface.items_tree if item.item_type == "SOCKET"}
    for name, default in ((FRONT, 0.0), (BACK, -1.0)):
        for in_out in ("INPUT", "OUTPUT"):
            if (name, in_out) not in have:
                socket = tree.interface.new_socket(name, in_out=in_out, socket_type="NodeSocketFloat")
                if in_out == "INPUT":
                    socket.default_value = default
    detail_group.add_settings(tree, SETTINGS)


def _draw(tree):
    _add_sockets(tree)
    graph = Graph(tree)
    inputs, outputs = graph.node("NodeGroupInput", 0, 0), graph.node("NodeGroupOutput", 8, 0)
    place = rest_coordinates.draw(graph, 0, 6)
    clouds = _varied(graph, inputs, place, "Clouds", "Cloud Size", 2)
    grain = _varied(graph, inputs, place, "Grain", "Grain Size", 5)
    left = graph.math("SUBTRACT", 4, 8, "not wiped", 1.0, inputs.outputs["Wiped"], clamp=True)
    both = graph.math("MULTIPLY", 5, 3, "clouds and grain", clouds, grain)
    kept = graph.math("MULTIPLY", 6, 3, "kept", both, left)
    strength = graph.node("ShaderNodeGroup", 6, 9, "Strength")
    strength.node_tree = dust_strength.group()
    factor = graph.math("MULTIPLY", 6, 4, "factor", kept, strength.outputs[0])
    graph.link(graph.math("MULTIPLY", 7, 0, FRONT, inputs.outputs[FRONT], factor), outputs.inputs[FRONT])
    # A negative thickness of the back stands for that of the front, and must stay negative.
    own = graph.math("MAXIMUM", 6, 1, "own", inputs.outputs[BACK], 0.0)
    none = graph.math("MINIMUM", 6, 2, "as the front", inputs.outputs[BACK], 0.0)
    graph.link(graph.math("MULTIPLY_ADD", 7, 1, BACK, own, factor, none), outputs.inputs[BACK])


def _varied(graph, inputs, place, strength, size, row):
    """The socket of 1 + strength x noise."""
    scale = graph.math("DIVIDE", 1, row, "per unit", 1.0, inputs.outputs[size])
    noise = graph.node("ShaderNodeTexNoise", 2, row, strength)
    noise.noise_dimensions = "3D"
    graph.link(place, noise.inputs["Vector"])
    graph.link(scale, noise.inputs["Scale"])
    noise.inputs["Detail"].default_value = _OCTAVES[strength]
    spread = graph.node("ShaderNodeMapRange", 3, row, "in [-1, 1]")
    spread.clamp = True
    low, high = 0.5 - _SPREAD[strength], 0.5 + _SPREAD[strength]
    for name, value in (("From Min", low), ("From Max", high), ("To Min", -1.0), ("To Max", 1.0)):
        spread.inputs[name].default_value = value
    graph.link(noise.outputs[0], spread.inputs["Value"])
    return graph.math("MULTIPLY_ADD", 4, row, "1 + strength noise", spread.outputs["Result"],
                      inputs.outputs[strength], 1.0)
