# SPDX-License-Identifier: GPL-3.0-or-later
"""Weights of the portal's rays where they leave, by path length, depth of the source, and curvature, and the
direction of the light there.

A node cannot pass numbers from one hit to the next. The depth of the source is therefore a function of the
ray's direction in world space, which both hits know: the azimuth, folded many times onto the table. See
lamina.subsurface.portal for the equations."""

import math

from . import portal_image
from .expression import arctangent, clamped, dot, exponential, maximum, ping_pong, sqrt

# Times that half a turn of the azimuth runs through the depths: an even number, see place_of_depth.
FOLDS = 64.0


def place_of_depth(graph, direction):
    """Place in the table of depths, in [0, 1], of a ray that runs along `direction` or against it.

    Uniform if the azimuth is. The triangle wave has the period 2 / FOLDS half turns, so half a turn changes
    nothing."""
    parts = graph.node("ShaderNodeSeparateXYZ", "direction")
    graph.link(direction, parts.inputs[0])
    x, y, _ = map(graph.value, parts.outputs)
    return ping_pong(arctangent(y, x) * (FOLDS / math.pi), 1.0).named("place of the depth")


def weight_and_normal(graph, tables, image, length, geometry, light_path):
    """(weight of a ray, a colour; normal of the closure) at the back face where the ray leaves.

    `tables`: lamina.PortalTables; `length`: the Blender units per millimetre; `geometry`, `light_path`: the
    values of the nodes by name."""
    incoming = geometry["Incoming"]
    cosine = dot(incoming, geometry["True Normal"]).named("exit cosine")
    depth = portal_image.depth(graph, image, place_of_depth(graph, incoming))
    way = (light_path["Ray Length"] / length).named("path length, mm")
    beyond = way - depth
    shape = _shape(tables, depth, way, beyond, way * cosine)
    # Beside an edge and in a hollow, t may be less than z. The factor for t = z limits the light there.
    beyond = maximum(beyond, 0.0).named("beyond the depth")
    between = (way * sqrt(shape)).named("t sqrt(u / h)")
    decayed = {0.0: shape}
    for k in _three(tables.decay):
        if k not in decayed:
            decayed[k] = ((between * k + shape) * exponential(beyond * -k)).named("in this channel")
    weight = graph.combined("weight at the exit", *(decayed[k] for k in _three(tables.decay)))
    normal = geometry["Normal"]
    if tables.tilt != 0.0:
        # The closure's light leans along the ray, away from the entry.
        level = incoming - geometry["True Normal"] * cosine
        normal = (level * tables.tilt + normal).named("tilted")
    return weight, normal


def _shape(tables, depth, way, beyond, height):
    """u / h, for the source's height h over the exit's tangent plane. The share s = z / 2 a of the depth z in
    the body is z (h - z) / (t^2 - z^2) on a sphere of radius a. A hollow surface counts as flat."""
    # Beside an edge, the other face is nearer than z: this face gets no more light than its rays are dense.
    ratio = clamped(depth / height).named("depth over height")
    if tables.curved == 0.0:
        return ratio
    share = (height - depth) / ((way + depth) * beyond) * depth
    return (ratio * clamped(1.0 - share) ** tables.curved).named("shape of the surface")


def _three(values):
    values = [float(value) for value in values]
    return values * 3 if len(values) == 1 else values
