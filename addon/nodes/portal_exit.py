# SPDX-License-Identifier: GPL-3.0-or-later
"""Weights of the portal's rays where they leave: by path length, exit angle, and the depth of the source.

A node cannot pass numbers from one hit to the next. The depth of the source is therefore a function of the
ray's direction in world space, which both hits know: the azimuth, folded many times onto the table."""

import math

from . import portal_image

# Times that half a turn of the azimuth runs through the depths: an even number, see place_of_depth.
FOLDS = 64.0
STEEPEST = 4.0  # limit of the weight for hollow surfaces, where rays graze


def place_of_depth(graph, direction):
    """Place in the table of depths, in [0, 1], of a ray that runs along `direction` or against it.

    Uniform if the azimuth is. The triangle wave has the period 2 / FOLDS half turns, so half a turn changes
    nothing."""
    parts = graph.node("ShaderNodeSeparateXYZ", -2, 18, "direction")
    graph.link(direction, parts.inputs[0])
    azimuth = graph.math("ARCTAN2", -1, 18, "azimuth", parts.outputs[1], parts.outputs[0])
    folded = graph.math("MULTIPLY", 0, 18, "folded", azimuth, FOLDS / math.pi)
    return graph.math("PINGPONG", 1, 18, "place of the depth", folded, 1.0)


def weight(graph, tables, image, length, geometry, light_path):
    """The weight of a ray, one number per channel, at the back face where the ray leaves.

    `tables`: lamina.PortalTables; `length`: socket with the Blender units per millimetre."""
    depth, way, height, between, beyond = _measured(graph, image, length, geometry, light_path)
    r = graph.math("SQRT", 2, 22, "distance on a plane", graph.math("MAXIMUM", 2, 23, "", between, 0.0))
    shown = portal_image.at_distance(graph, image, tables.scale, r)
    ratio = _ratio(graph, depth, height, _past(graph, depth, height, between))
    by_channel = graph.node("ShaderNodeCombineXYZ", 5, 24, "decay")
    done = {}
    for channel, decay in enumerate(_three(tables.decay)):
        if decay not in done:
            done[decay] = _decayed(graph, decay, way, beyond, ratio)
        graph.link(done[decay], by_channel.inputs[channel])
    return graph.vector("MULTIPLY", 6, 22, "weight at the exit", shown, by_channel.outputs[0])


def share_within(graph, image, length, geometry, light_path):
    """The weight of a ray that was weighted by distance already: see _past. One number."""
    depth, _, height, between, _ = _measured(graph, image, length, geometry, light_path)
    return _past(graph, depth, height, between)


def _measured(graph, image, length, geometry, light_path):
    """Of the ray that leaves, in mm: the depth z of its source, its length t, the height of the source over
    the tangent plane of the exit, t^2 - z^2, and t - z."""
    incoming = geometry.outputs["Incoming"]
    place = place_of_depth(graph, incoming)
    table = portal_image.row(graph, image, portal_image.DEPTHS, "depth of the source", place, "Closest")
    depth = _single(graph, table)
    way = graph.math("DIVIDE", 0, 20, "path length, mm", light_path.outputs["Ray Length"], length)
    cosine = graph.vector("DOT_PRODUCT", 0, 21, "exit cosine", incoming, geometry.outputs["True Normal"])
    height = graph.math("MULTIPLY", 1, 21, "height over the exit", way, cosine)
    beyond = graph.math("SUBTRACT", 0, 23, "beyond the depth", way, depth)
    between = graph.math("MULTIPLY", 1, 22, "", graph.math("ADD", 0, 22, "", way, depth), beyond)
    return depth, way, height, between, beyond


def _ratio(graph, depth, height, past):
    """Ratio of z / (2 pi t^3) to the density of hits on the surface: the depth z over the source's height
    above the tangent plane of the exit, and the share `past`."""
    least = graph.math("DIVIDE", 1, 20, "", depth, STEEPEST)
    ratio = graph.math("DIVIDE", 3, 20, "depth over height", depth,
                       graph.math("MAXIMUM", 2, 20, "", height, least))
    return graph.math("MULTIPLY", 5, 20, "shape of the surface", ratio, past)


def _past(graph, depth, height, between):
    """The share of a source by its place in the body. On a sphere of radius a, (height - z) / (t^2 - z^2) is
    1 / (2 a). From the centre on, z > a, the source counts less, and nothing on the other side: a plane has
    no such sources, and light from there has left on the other side."""
    bend = graph.math("DIVIDE", 3, 21, "curvature", graph.math("SUBTRACT", 2, 21, "", height, depth),
                      graph.math("MAXIMUM", 2, 22, "", between, 1.0e-12))
    share = graph.math("MULTIPLY", 3, 22, "", bend, depth)
    return graph.math("MULTIPLY_ADD", 4, 21, "from the centre on", share, -2.0, 2.0, clamp=True)


def _decayed(graph, decay, way, beyond, ratio):
    """`ratio` times (1 + k t) exp(-k (t - z)), where `beyond` is t - z."""
    beyond = graph.math("MAXIMUM", 1, 24, "", beyond, 0.0)
    exponent = graph.math("MULTIPLY", 2, 24, "", beyond, -decay)
    fall = graph.math("EXPONENT", 3, 24, "fall", exponent)
    near = graph.math("MULTIPLY_ADD", 2, 25, "near the source", way, decay, 1.0)
    both = graph.math("MULTIPLY", 4, 25, "", fall, near)
    return graph.math("MULTIPLY", 4, 24, "in this channel", both, ratio)


def _single(graph, colour):
    """A number from a colour whose channels are equal."""
    parts = graph.node("ShaderNodeSeparateColor", 4, 18)
    graph.link(colour, parts.inputs[0])
    return parts.outputs[0]


def _three(values):
    values = [float(value) for value in values]
    return values * 3 if len(values) == 1 else values
