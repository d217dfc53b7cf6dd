# SPDX-License-Identifier: GPL-3.0-or-later
"""What lies in dust as single things: fibers and specks, which add to the thickness where they are.

Fibers are strips along a piece of a sine curve, one in each cell of a Voronoi pattern with a random number
below the share. The pattern is plane, on the nearest side of a cube around the object, since a plane curve
in space would meet the surface in points. Specks are the peaks of a noise above a limit. The share grows with
the amount of dust, and the limit falls, so that clean ground has neither.
"""

import math

from . import texture_graph
from .expression import clamped, floor, maximum, sine

SIZES = {"Fiber Length": 0.008, "Speck Size": 0.0005}  # in metres
SHARES = {"Fibers": 0.5, "Specks": 0.4}  # of a new node
LEAST = 0.02  # optical thickness of dust from which litter is seen in full

# (name, subtype, default, least, most, description) of the settings. The defaults are those of nodes of
# earlier versions, which stay as they were.
SETTINGS = (
    ("Fibers", "FACTOR", 0.0, 0.0, 1.0, "Share of fibers: 1 for one on each square of their length"),
    ("Fiber Length", "DISTANCE", SIZES["Fiber Length"], 1e-5, 1e4, "Length of long fibers in the world"),
    ("Specks", "FACTOR", 0.0, 0.0, 1.0, "How many specks lie in dust"),
    ("Speck Size", "DISTANCE", SIZES["Speck Size"], 1e-6, 1e4, "Diameter of large specks in the world"),
)

_THICK = 3.0  # optical thickness in the middle of a fiber or speck
_HALF = 0.1  # optical thickness of dust with half of the fibers and specks
_WIDTH = 0.0125  # of a fiber, over its length
# Specks: distance of the noise's peaks over the diameter; the limit below the noise's largest value 1 at the
# share 1; the root by which the limit depends on the share, so that the covered area is about proportional to
# the share; and what makes their sides steep.
_APART, _LIMIT, _ROOT, _STEEP = 1.4, 0.21, 1.0 / 3.0, 30.0


def draw(graph, inputs, places, amount):
    """The optical thickness of the litter, in dust of the thickness `amount`. `places`: coordinates, and the
    same in turned axes."""
    place, turned = places
    share = clamped(amount / (amount + _HALF)).named("share of litter")
    fibers = _fibers(graph, inputs, _plane(graph, place), share)
    specks = _specks(graph, inputs, turned, share)
    return (maximum(fibers, specks) * _THICK).named("litter")


def _plane(graph, place):
    """Coordinates in the plane of the nearest side of a cube."""
    normal = graph.value(graph.node("ShaderNodeTexCoord", "normal").outputs["Normal"])
    # Weights, at most 1 for the steps below: on faces at 45 degrees no two sides are equally near.
    near = abs(normal * (0.94, 0.97, 1.0))
    x, y, z = texture_graph.parts(graph, near)
    below = maximum(maximum(x, y), z) - (1.0 + 1e-5)
    side = floor(near - below).named("1 at the nearest side")
    # The sides across x and y have z in place of x or y.
    height = texture_graph.parts(graph, place)[2]
    return side * (height - place) + place


def _if_any(wanted, value):
    """`value`, or 0 if none are wanted. For a fixed 0, Cycles then leaves out all that leads here."""
    return value * (wanted > 0.0).named("any")


def _fibers(graph, inputs, plane, share):
    """1 in the middle of fibers, 0 beside them."""
    wanted = inputs["Fibers"]
    lengths = plane / inputs["Fiber Length"]
    node = graph.node("ShaderNodeTexVoronoi", "fibers")
    node.voronoi_dimensions, node.feature, node.distance = "2D", "F1", "EUCLIDEAN"
    node.inputs["Scale"].default_value = node.inputs["Randomness"].default_value = 1.0
    graph.link(lengths, node.inputs["Vector"])
    cells = graph.values(node)
    turn, bend, chance = texture_graph.parts(graph, cells["Color"])
    present = (chance < wanted * share).named("is there")
    rotated = graph.node("ShaderNodeVectorRotate", "along the fiber")
    rotated.rotation_type = "Z_AXIS"
    graph.link(lengths - cells["Position"], rotated.inputs["Vector"])
    graph.link(turn * (2.0 * math.pi), rotated.inputs["Angle"])
    along, across, _ = texture_graph.parts(graph, rotated.outputs[0])
    wave = sine(along * 5.5 + bend * 41.0).named("wave")
    beside = (wave * (bend * -0.16) + across).named("beside the curve")
    strip = clamped(1.0 - beside**2 * (4.0 / _WIDTH**2)).named("strip")
    ends = (abs(along) < chance * 0.4 + 0.1).named("not beyond its ends")
    return _if_any(wanted, strip * ends * present)


def _specks(graph, inputs, place, share):
    """1 in the middle of specks, 0 beside them."""
    wanted = inputs["Specks"]
    noise = texture_graph.noise(graph, "specks", place, 1.0 / _APART / inputs["Speck Size"], 0.0)
    limit = 1.0 - (wanted * share) ** _ROOT * _LIMIT
    speck = clamped((graph.value(noise.outputs[0]) - limit) * _STEEP)
    return _if_any(wanted, speck)
