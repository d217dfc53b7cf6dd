# SPDX-License-Identifier: GPL-3.0-or-later
"""Weights of the portal's rays where they leave, by path length, depth of the source, and curvature, and the
direction of the light there.

A node cannot pass numbers from one hit to the next. The depth of the source is therefore a function of the
ray's direction in world space, which both hits know: the azimuth, folded many times onto the table. See
lamina.subsurface.portal for the equations."""

import math

from . import portal_image

# Times that half a turn of the azimuth runs through the depths: an even number, see place_of_depth.
FOLDS = 64.0


def place_of_depth(graph, direction):
    """Place in the table of depths, in [0, 1], of a ray that runs along `direction` or against it.

    Uniform if the azimuth is. The triangle wave has the period 2 / FOLDS half turns, so half a turn changes
    nothing."""
    parts = graph.node("ShaderNodeSeparateXYZ", "direction")
    graph.link(direction, parts.inputs[0])
    azimuth = graph.math("ARCTAN2", "azimuth", parts.outputs[1], parts.outputs[0])
    folded = graph.math("MULTIPLY", "folded", azimuth, FOLDS / math.pi)
    return graph.math("PINGPONG", "place of the depth", folded, 1.0)


def weight_and_normal(graph, tables, image, length, geometry, light_path):
    """(weight of a ray, a colour; normal of the closure) at the back face where the ray leaves.

    `tables`: lamina.PortalTables; `length`: socket with the Blender units per millimetre."""
    incoming, flat = geometry.outputs["Incoming"], geometry.outputs["True Normal"]
    cosine = graph.vector("DOT_PRODUCT", "exit cosine", incoming, flat)
    depth = portal_image.depth(graph, image, place_of_depth(graph, incoming))
    way = graph.math("DIVIDE", "path length, mm", light_path.outputs["Ray Length"], length)
    beyond = graph.math("SUBTRACT", "beyond the depth", way, depth)
    shape = _shape(graph, tables, depth, way, beyond, graph.math("MULTIPLY", "height", way, cosine))
    by_channel = graph.node("ShaderNodeCombineXYZ", "weight at the exit")
    between = graph.math("MULTIPLY", "", way, graph.math("SQRT", "", shape))
    # Beside an edge and in a hollow, t may be less than z. The factor for t = z limits the light there.
    beyond = graph.math("MAXIMUM", "", beyond, 0.0)
    done = {}
    for channel, decay in enumerate(_three(tables.decay)):
        if decay not in done:
            done[decay] = _decayed(graph, decay, beyond, shape, between)
        graph.link(done[decay], by_channel.inputs[channel])
    return by_channel.outputs[0], _tilted(graph, tables, geometry, cosine)


def _shape(graph, tables, depth, way, beyond, height):
    """u / h, for the source's height h over the exit's tangent plane. The share s = z / 2 a of the depth z in
    the body is z (h - z) / (t^2 - z^2) on a sphere of radius a. A hollow surface counts as flat."""
    # Beside an edge, the other face is nearer than z: this face gets no more light than its rays are dense.
    ratio = graph.math("DIVIDE", "depth over height", depth, height, clamp=True)
    if tables.curved == 0.0:
        return ratio
    square = graph.math("MULTIPLY", "", graph.math("ADD", "", way, depth), beyond)
    rise = graph.math("SUBTRACT", "rise", height, depth)
    share = graph.math("MULTIPLY", "", graph.math("DIVIDE", "curvature", rise, square), depth)
    rest = graph.math("SUBTRACT", "rest of the body", 1.0, share, clamp=True)
    rest = graph.math("POWER", "", rest, tables.curved)
    return graph.math("MULTIPLY", "shape of the surface", ratio, rest)


def _decayed(graph, decay, beyond, shape, between):
    """(u / h + k t sqrt(u / h)) exp(-k (t - z)). `between`: t sqrt(u / h); `beyond`: t - z."""
    if decay == 0.0:
        return shape
    fall = graph.math("EXPONENT", "fall", graph.math("MULTIPLY", "", beyond, -decay))
    light = graph.math("MULTIPLY_ADD", "light of the source", between, decay, shape)
    return graph.math("MULTIPLY", "in this channel", fall, light)


def _tilted(graph, tables, geometry, cosine):
    """The normal, tilted so that the closure's light leans along the ray, away from the entry."""
    normal = geometry.outputs["Normal"]
    if tables.tilt == 0.0:
        return normal
    upwards = graph.scale("", geometry.outputs["True Normal"], cosine)
    level = graph.vector("SUBTRACT", "level", geometry.outputs["Incoming"], upwards)
    return graph.vector("MULTIPLY_ADD", "tilted", level, (tables.tilt,) * 3, normal)


def _three(values):
    values = [float(value) for value in values]
    return values * 3 if len(values) == 1 else values
