# SPDX-License-Identifier: GPL-3.0-or-later
"""What lies in dust as single things: fibers and specks, which add to the thickness where they are.

Fibers are strips along a piece of a sine curve, one in each cell of a Voronoi pattern with a random number
below the share. The pattern is plane, on the nearest side of a cube around the object, since a plane curve
in space would meet the surface in points. Specks are the peaks of a noise above a limit. The share grows with
the amount of dust, and the limit falls, so that clean ground has neither.
"""

import math

from . import texture_graph

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


def draw(graph, inputs, places, amount, row):
    """The socket of the optical thickness of the litter, in dust of the thickness `amount`. `places`: sockets
    of coordinates, and of the same in turned axes."""
    place, turned = places
    half = graph.math("ADD", 2, row, "amount + half", amount, _HALF)
    share = graph.math("DIVIDE", 3, row, "share of litter", amount, half, clamp=True)
    fibers = _fibers(graph, inputs, _plane(graph, place, row + 2), share, row + 10)
    specks = _specks(graph, inputs, turned, share, row + 16)
    both = graph.math("MAXIMUM", 15, row + 10, "fibers and specks", fibers, specks)
    return graph.math("MULTIPLY", 16, row + 10, "litter", both, _THICK)


def _plane(graph, place, row):
    """The socket of coordinates in the plane of the nearest side of a cube."""
    normal = graph.node("ShaderNodeTexCoord", 2, row, "normal").outputs["Normal"]
    # Weights, at most 1 for the steps below: on faces at 45 degrees no two sides are equally near.
    weighted = graph.vector("MULTIPLY", 3, row, "weighted", normal, (0.94, 0.97, 1.0))
    near = graph.vector("ABSOLUTE", 4, row, "near", weighted)
    along = texture_graph.parts(graph, 5, row, near)
    most = graph.math("MAXIMUM", 5, row + 1, "x or y", *along[:2])
    most = graph.math("MAXIMUM", 6, row, "nearest", most, along[2])
    below = graph.math("SUBTRACT", 7, row, "just below", most, 1.0 + 1e-5)
    side = graph.vector("FLOOR", 9, row, "side", graph.vector(
        "SUBTRACT", 8, row, "1 at the nearest", near, below))
    # The sides across x and y have z in place of x or y.
    height = texture_graph.parts(graph, 5, row + 3, place)[2]
    turned = graph.vector("SUBTRACT", 6, row + 3, "to z", height, place)
    return graph.vector("MULTIPLY_ADD", 10, row, "plane", side, turned, place)


def _if_any(graph, wanted, value, column, row):
    """`value`, or 0 if none are wanted. For a fixed 0, Cycles then leaves out all that leads here."""
    return graph.math("MULTIPLY", column + 1, row, "if any", value, graph.math(
        "GREATER_THAN", column, row, "any", wanted, 0.0))


def _fibers(graph, inputs, plane, share, row):
    """1 in the middle of fibers, 0 beside them."""
    wanted, length = inputs.outputs["Fibers"], inputs.outputs["Fiber Length"]
    lengths = graph.scale(2, row, "in lengths", plane, graph.math("DIVIDE", 1, row, "per unit", 1.0, length))
    cells = graph.node("ShaderNodeTexVoronoi", 3, row, "fibers")
    cells.voronoi_dimensions, cells.feature, cells.distance = "2D", "F1", "EUCLIDEAN"
    cells.inputs["Scale"].default_value = cells.inputs["Randomness"].default_value = 1.0
    graph.link(lengths, cells.inputs["Vector"])
    turn, bend, chance = texture_graph.parts(graph, 4, row, cells.outputs["Color"])
    present = graph.math("LESS_THAN", 6, row + 2, "is there", chance, graph.math(
        "MULTIPLY", 5, row + 2, "wanted here", wanted, share))
    away = graph.vector("SUBTRACT", 5, row, "from the middle", lengths, cells.outputs["Position"])
    rotated = graph.node("ShaderNodeVectorRotate", 7, row, "along the fiber")
    rotated.rotation_type = "Z_AXIS"
    graph.link(away, rotated.inputs["Vector"])
    graph.link(graph.math("MULTIPLY", 6, row + 1, "any way", turn, 2.0 * math.pi), rotated.inputs["Angle"])
    along, across, _ = texture_graph.parts(graph, 8, row, rotated.outputs[0])
    phase = graph.math("MULTIPLY", 8, row + 1, "phase", bend, 41.0)
    wave = graph.math("SINE", 10, row, "wave", graph.math("MULTIPLY_ADD", 9, row, "phase", along, 5.5, phase))
    high = graph.math("MULTIPLY", 9, row + 1, "height", bend, -0.16)
    beside = graph.math("MULTIPLY_ADD", 11, row, "beside the curve", wave, high, across)
    square = graph.math("MULTIPLY", 12, row, "square", beside, beside)
    strip = graph.math("MULTIPLY_ADD", 13, row, "strip", square, -4.0 / _WIDTH**2, 1.0, clamp=True)
    reach = graph.math("MULTIPLY_ADD", 9, row + 2, "half length", chance, 0.4, 0.1)
    ends = graph.math("LESS_THAN", 11, row + 2, "not beyond its ends", graph.math(
        "ABSOLUTE", 10, row + 2, "along", along), reach)
    piece = graph.math("MULTIPLY", 14, row, "piece", strip, ends)
    return _if_any(graph, wanted, graph.math("MULTIPLY", 15, row, "fiber", piece, present), 15, row + 1)


def _specks(graph, inputs, place, share, row):
    """1 in the middle of specks, 0 beside them."""
    wanted = inputs.outputs["Specks"]
    scale = graph.math("DIVIDE", 2, row, "per unit", 1.0 / _APART, inputs.outputs["Speck Size"])
    noise = texture_graph.noise(graph, 3, row, "specks", place, scale, 0.0)
    here = graph.math("POWER", 5, row + 1, "wanted here", graph.math(
        "MULTIPLY", 4, row + 1, "share", wanted, share), _ROOT)
    above = graph.math("MULTIPLY_ADD", 6, row + 1, "below 1", here, _LIMIT, -1.0)
    over = graph.math("ADD", 7, row, "over the limit", noise.outputs[0], above)
    speck = graph.math("MULTIPLY", 8, row, "speck", over, _STEEP, clamp=True)
    return _if_any(graph, wanted, speck, 9, row)
