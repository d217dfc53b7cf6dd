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


def draw(graph, inputs, places, amount):
    """The socket of the optical thickness of the litter, in dust of the thickness `amount`. `places`: sockets
    of coordinates, and of the same in turned axes."""
    place, turned = places
    half = graph.math("ADD", "amount + half", amount, _HALF)
    share = graph.math("DIVIDE", "share of litter", amount, half, clamp=True)
    fibers = _fibers(graph, inputs, _plane(graph, place), share)
    specks = _specks(graph, inputs, turned, share)
    both = graph.math("MAXIMUM", "fibers and specks", fibers, specks)
    return graph.math("MULTIPLY", "litter", both, _THICK)


def _plane(graph, place):
    """The socket of coordinates in the plane of the nearest side of a cube."""
    normal = graph.node("ShaderNodeTexCoord", "normal").outputs["Normal"]
    # Weights, at most 1 for the steps below: on faces at 45 degrees no two sides are equally near.
    weighted = graph.vector("MULTIPLY", "weighted", normal, (0.94, 0.97, 1.0))
    near = graph.vector("ABSOLUTE", "near", weighted)
    along = texture_graph.parts(graph, near)
    most = graph.math("MAXIMUM", "x or y", *along[:2])
    most = graph.math("MAXIMUM", "nearest", most, along[2])
    below = graph.math("SUBTRACT", "just below", most, 1.0 + 1e-5)
    side = graph.vector("FLOOR", "side", graph.vector("SUBTRACT", "1 at the nearest", near, below))
    # The sides across x and y have z in place of x or y.
    height = texture_graph.parts(graph, place)[2]
    turned = graph.vector("SUBTRACT", "to z", height, place)
    return graph.vector("MULTIPLY_ADD", "plane", side, turned, place)


def _if_any(graph, wanted, value):
    """`value`, or 0 if none are wanted. For a fixed 0, Cycles then leaves out all that leads here."""
    return graph.math("MULTIPLY", "if any", value, graph.math("GREATER_THAN", "any", wanted, 0.0))


def _fibers(graph, inputs, plane, share):
    """1 in the middle of fibers, 0 beside them."""
    wanted, length = inputs.outputs["Fibers"], inputs.outputs["Fiber Length"]
    lengths = graph.scale("in lengths", plane, graph.math("DIVIDE", "per unit", 1.0, length))
    cells = graph.node("ShaderNodeTexVoronoi", "fibers")
    cells.voronoi_dimensions, cells.feature, cells.distance = "2D", "F1", "EUCLIDEAN"
    cells.inputs["Scale"].default_value = cells.inputs["Randomness"].default_value = 1.0
    graph.link(lengths, cells.inputs["Vector"])
    turn, bend, chance = texture_graph.parts(graph, cells.outputs["Color"])
    here = graph.math("MULTIPLY", "wanted here", wanted, share)
    present = graph.math("LESS_THAN", "is there", chance, here)
    away = graph.vector("SUBTRACT", "from the middle", lengths, cells.outputs["Position"])
    rotated = graph.node("ShaderNodeVectorRotate", "along the fiber")
    rotated.rotation_type = "Z_AXIS"
    graph.link(away, rotated.inputs["Vector"])
    graph.link(graph.math("MULTIPLY", "any way", turn, 2.0 * math.pi), rotated.inputs["Angle"])
    along, across, _ = texture_graph.parts(graph, rotated.outputs[0])
    phase = graph.math("MULTIPLY", "phase", bend, 41.0)
    wave = graph.math("SINE", "wave", graph.math("MULTIPLY_ADD", "phase", along, 5.5, phase))
    high = graph.math("MULTIPLY", "height", bend, -0.16)
    beside = graph.math("MULTIPLY_ADD", "beside the curve", wave, high, across)
    square = graph.math("MULTIPLY", "square", beside, beside)
    strip = graph.math("MULTIPLY_ADD", "strip", square, -4.0 / _WIDTH**2, 1.0, clamp=True)
    reach = graph.math("MULTIPLY_ADD", "half length", chance, 0.4, 0.1)
    ends = graph.math("LESS_THAN", "not beyond its ends", graph.math("ABSOLUTE", "along", along), reach)
    piece = graph.math("MULTIPLY", "piece", strip, ends)
    return _if_any(graph, wanted, graph.math("MULTIPLY", "fiber", piece, present))


def _specks(graph, inputs, place, share):
    """1 in the middle of specks, 0 beside them."""
    wanted = inputs.outputs["Specks"]
    scale = graph.math("DIVIDE", "per unit", 1.0 / _APART, inputs.outputs["Speck Size"])
    noise = texture_graph.noise(graph, "specks", place, scale, 0.0)
    here = graph.math("POWER", "wanted here", graph.math("MULTIPLY", "share", wanted, share), _ROOT)
    above = graph.math("MULTIPLY_ADD", "below 1", here, _LIMIT, -1.0)
    over = graph.math("ADD", "over the limit", noise.outputs[0], above)
    speck = graph.math("MULTIPLY", "speck", over, _STEEP, clamp=True)
    return _if_any(graph, wanted, speck)
