# SPDX-License-Identifier: GPL-3.0-or-later
"""A tabulated BSSRDF: Ray Portal BSDF, sources below the surface, and tables of lamina.portal_tables.

A camera ray that hits a front face continues from a source below the hit point, in a random upward direction.
The continued ray hits a back face. A Translucent closure there collects the light from outside. Rays are
weighted where they leave (portal_exit)."""

import math

import numpy as np

from . import boundary_graph, mix_shader, portal_exit, portal_image, portal_volume

# The step to the outside: a part of the mean exit distance, Blender units, and a part of the distance from
# the origin. Cycles misses the surface of a metre-wide face from 6e-6 units above; 1.3e-4 is enough.
STEP, LEAST_STEP, ROUNDING = 0.05, 6.0e-5, 3.0e-5
# Scale of the position for White Noise: about 1000 steps per millimetre give neighbours different numbers.
NOISE_SCALE = 917.3
ASIDE = (0.8017837, 0.2672612, 0.5345225)  # helper axis for the tangent frame; unlikely to equal a normal


def draw(graph, tables, length, name):
    """Add the nodes and return the sockets (shader, volume). Without first orders the volume is None.

    `tables`: lamina.PortalTables; `length`: the socket with the number of Blender units per millimetre;
    `name`: name of the image."""
    # Over the share of the views that take the portal, times the integral of the cosines' density.
    views = tables.views[:, None] * tables.shares * ((0.5 + tables.lift) / (1.0 - tables.entering))
    image = portal_image.create(name, tables.depths, views)
    geometry = graph.node("ShaderNodeNewGeometry", -3, 4)
    light_path = graph.node("ShaderNodeLightPath", -3, 10)
    chance = _chance(graph, geometry.outputs["Position"], length)
    shader = _to_the_source(graph, tables, length, geometry, image, chance)
    volume = None
    if tables.first is not None:
        shader, volume = portal_volume.with_volume(graph, tables, length, light_path, shader, chance[1])
    weight, tilted = portal_exit.weight_and_normal(graph, tables, image, length, geometry, light_path)
    if tables.has_boundary:
        shader = boundary_graph.over(graph, tables.ior, tables.roughness, shader)
    return _by_side(graph, tables, length, geometry, light_path, shader, volume, (weight, tilted)), volume


def _to_the_source(graph, tables, length, geometry, image, chance):
    """The portal from the front face to the source."""
    normal = geometry.outputs["Normal"]
    cosine, sine, density = _cosine(graph, tables.lift, chance[0])
    # A full turn for the random numbers that rays into the volume leave over.
    turn = 2.0 * math.pi / (1.0 - tables.entering)
    direction = _direction(graph, normal, cosine, sine, chance[1], turn)
    place = portal_exit.place_of_depth(graph, direction)
    depth = portal_image.depth(graph, image, place)
    seen = graph.vector("DOT_PRODUCT", 0, 12, "view cosine", normal, geometry.outputs["Incoming"])
    weight = portal_image.by_view(graph, image, place, seen)
    portal = graph.node("ShaderNodeBsdfRayPortal", 4, 6, "to the source")
    inverse = graph.math("DIVIDE", 2, 9, "", 1.0, density)
    graph.link(graph.scale(3, 9, "over the cosines' density", weight, inverse), portal.inputs["Color"])
    way = graph.math("MULTIPLY", 1, 5, "depth of the source", depth, length)
    below = graph.scale(2, 5, "down", normal, way)
    source = graph.vector("SUBTRACT", 3, 5, "source", geometry.outputs["Position"], below)
    graph.link(source, portal.inputs["Position"])
    graph.link(direction, portal.inputs["Direction"])
    return portal.outputs[0]


def _chance(graph, position, length):
    """Two random numbers, uniform in [0, 1), for the shading point."""
    fine = graph.math("DIVIDE", -2, 6, "steps", NOISE_SCALE, length)
    noise = graph.node("ShaderNodeTexWhiteNoise", -1, 6, "chance")
    noise.noise_dimensions = "3D"
    graph.link(graph.scale(-2, 7, "in steps", position, fine), noise.inputs["Vector"])
    parts = graph.node("ShaderNodeSeparateColor", 0, 6, "chance")
    graph.link(noise.outputs["Color"], parts.inputs[0])
    return tuple(parts.outputs)[:2]


def _cosine(graph, lift, chance):
    """(cosine, sine, cosine + lift) of the angle between the source's ray and the normal. The square of the
    last is uniform."""
    square = graph.math("MULTIPLY_ADD", 0, 7, "", chance, 1.0 + 2.0 * lift, lift * lift)
    lifted = graph.math("SQRT", 1, 7, "lifted", square)
    cosine = graph.math("SUBTRACT", 2, 7, "cosine", lifted, lift)
    rest = graph.math("SUBTRACT", 4, 7, "rest", 1.0, graph.math("MULTIPLY", 3, 7, "square", cosine, cosine))
    return cosine, graph.math("SQRT", 6, 7, "sine", graph.math("MAXIMUM", 5, 7, "", rest, 0.0)), lifted


def _direction(graph, normal, cosine, sine, chance, turn):
    angle = graph.math("MULTIPLY", 0, 14, "azimuth", chance, turn)
    first = graph.vector("CROSS_PRODUCT", 0, 15, "across", normal, ASIDE)
    first = graph.vector("NORMALIZE", 1, 15, "first axis", first)
    second = graph.vector("CROSS_PRODUCT", 2, 15, "second axis", normal, first)
    along = graph.math("MULTIPLY", 2, 14, "along the first", sine, graph.math("COSINE", 1, 14, "", angle))
    aside = graph.math("MULTIPLY", 2, 16, "along the second", sine, graph.math("SINE", 1, 16, "", angle))
    level = graph.vector(
        "ADD", 4, 15, "level",
        graph.scale(3, 15, "", first, along),
        graph.scale(3, 16, "", second, aside),
    )
    return graph.vector("ADD", 5, 15, "direction", level, graph.scale(4, 16, "upwards", normal, cosine))


def _by_side(graph, tables, length, geometry, light_path, shader, volume, leaving):
    """The shader of both faces: on the back face, rays from the source show the light from outside, and the
    front face gets `shader`. `leaving`: weight and tilted normal where a ray leaves."""
    weight, tilted = leaving
    lit = graph.node("ShaderNodeBsdfTranslucent", 6, 9, "light from outside")
    _colour(graph, lit, portal_volume.rgb(tables.entry.diffuse), weight)
    graph.link(tilted, lit.inputs["Normal"])
    behind, front = lit.outputs[0], shader
    if tables.entry.toon.any():
        leave, front = _by_toon(graph, tables, length, geometry, light_path, shader, weight)
        behind = mix_shader.added(graph, 7, 9, "all that enters", behind, leave)
    if volume is not None:
        behind = portal_volume.behind(graph, light_path, behind)
    return mix_shader.between(graph, 7, 6, "from inside", geometry.outputs["Backfacing"], front, behind)


def _by_toon(graph, tables, length, geometry, light_path, shader, weight):
    """The shaders (back face, front face) of light that enters as a Toon closure reflects it.

    Cycles cannot sample a Toon closure on a back face, so a part of the rays goes on to a point just outside,
    and back to the front face. There rays as short as that step show the Toon closure. All others are views
    and get `shader`."""
    normal, position = geometry.outputs["True Normal"], geometry.outputs["Position"]
    step = _step(graph, tables, length, position)
    leave = graph.node("ShaderNodeBsdfRayPortal", 6, 8, "to the outside")
    _colour(graph, leave, portal_volume.rgb(tables.entry.toon), weight)
    outside = graph.vector("SUBTRACT", 5, 9, "outside", position, graph.scale(4, 9, "a step", normal, step))
    graph.link(outside, leave.inputs["Position"])
    graph.link(normal, leave.inputs["Direction"])
    toon = graph.node("ShaderNodeBsdfToon", 4, 15, "light from outside")
    toon.component = "DIFFUSE"
    toon.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    toon.inputs["Size"].default_value = tables.entry.size
    toon.inputs["Smooth"].default_value = tables.entry.smooth
    limit = graph.math("MULTIPLY", 4, 12, "twice", step, 2.0)
    near = graph.math("LESS_THAN", 5, 12, "came from the step", light_path.outputs["Ray Length"], limit)
    front = mix_shader.between(graph, 6, 6, "from outside", near, shader, toon.outputs[0])
    return leave.outputs[0], front


def _colour(graph, node, colour, weight):
    """Set the color of a closure, times the socket `weight`."""
    graph.link(graph.vector("MULTIPLY", 5, 10, "weighted", weight, colour), node.inputs["Color"])


def _step(graph, tables, length, position):
    """Distance between the surface and the point outside: a small part of the profile, and above the rounding
    errors of the position."""
    away = graph.vector("LENGTH", 2, 12, "from the origin", position)
    far = graph.math("MULTIPLY_ADD", 3, 12, "rounding", away, ROUNDING, LEAST_STEP)
    return graph.math("MULTIPLY_ADD", 4, 11, "a step", length, STEP * float(np.median(tables.distance)), far)
