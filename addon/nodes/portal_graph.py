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
    geometry = graph.node("ShaderNodeNewGeometry")
    light_path = graph.node("ShaderNodeLightPath")
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
    seen = graph.vector("DOT_PRODUCT", "view cosine", normal, geometry.outputs["Incoming"])
    weight = portal_image.by_view(graph, image, place, seen)
    portal = graph.node("ShaderNodeBsdfRayPortal", "to the source")
    inverse = graph.math("DIVIDE", "", 1.0, density)
    graph.link(graph.scale("over the cosines' density", weight, inverse), portal.inputs["Color"])
    way = graph.math("MULTIPLY", "depth of the source", depth, length)
    below = graph.scale("down", normal, way)
    source = graph.vector("SUBTRACT", "source", geometry.outputs["Position"], below)
    graph.link(source, portal.inputs["Position"])
    graph.link(direction, portal.inputs["Direction"])
    return portal.outputs[0]


def _chance(graph, position, length):
    """Two random numbers, uniform in [0, 1), for the shading point."""
    fine = graph.math("DIVIDE", "steps", NOISE_SCALE, length)
    noise = graph.node("ShaderNodeTexWhiteNoise", "chance")
    noise.noise_dimensions = "3D"
    graph.link(graph.scale("in steps", position, fine), noise.inputs["Vector"])
    parts = graph.node("ShaderNodeSeparateColor", "chance")
    graph.link(noise.outputs["Color"], parts.inputs[0])
    return tuple(parts.outputs)[:2]


def _cosine(graph, lift, chance):
    """(cosine, sine, cosine + lift) of the angle between the source's ray and the normal. The square of the
    last is uniform."""
    square = graph.math("MULTIPLY_ADD", "", chance, 1.0 + 2.0 * lift, lift * lift)
    lifted = graph.math("SQRT", "lifted", square)
    cosine = graph.math("SUBTRACT", "cosine", lifted, lift)
    rest = graph.math("SUBTRACT", "rest", 1.0, graph.math("MULTIPLY", "square", cosine, cosine))
    return cosine, graph.math("SQRT", "sine", graph.math("MAXIMUM", "", rest, 0.0)), lifted


def _direction(graph, normal, cosine, sine, chance, turn):
    angle = graph.math("MULTIPLY", "azimuth", chance, turn)
    first = graph.vector("CROSS_PRODUCT", "across", normal, ASIDE)
    first = graph.vector("NORMALIZE", "first axis", first)
    second = graph.vector("CROSS_PRODUCT", "second axis", normal, first)
    along = graph.math("MULTIPLY", "along the first", sine, graph.math("COSINE", "", angle))
    aside = graph.math("MULTIPLY", "along the second", sine, graph.math("SINE", "", angle))
    level = graph.vector("ADD", "level", graph.scale("", first, along), graph.scale("", second, aside))
    return graph.vector("ADD", "direction", level, graph.scale("upwards", normal, cosine))


def _by_side(graph, tables, length, geometry, light_path, shader, volume, leaving):
    """The shader of both faces: on the back face, rays from the source show the light from outside, and the
    front face gets `shader`. `leaving`: weight and tilted normal where a ray leaves."""
    weight, tilted = leaving
    lit = graph.node("ShaderNodeBsdfTranslucent", "light from outside")
    _colour(graph, lit, portal_volume.rgb(tables.entry.diffuse), weight)
    graph.link(tilted, lit.inputs["Normal"])
    behind, front = lit.outputs[0], shader
    if tables.entry.toon.any():
        leave, front = _by_toon(graph, tables, length, geometry, light_path, shader, weight)
        behind = mix_shader.added(graph, "all that enters", behind, leave)
    if volume is not None:
        behind = portal_volume.behind(graph, light_path, behind)
    return mix_shader.between(graph, "from inside", geometry.outputs["Backfacing"], front, behind)


def _by_toon(graph, tables, length, geometry, light_path, shader, weight):
    """The shaders (back face, front face) of light that enters as a Toon closure reflects it.

    Cycles cannot sample a Toon closure on a back face, so a part of the rays goes on to a point just outside,
    and back to the front face. There rays as short as that step show the Toon closure. All others are views
    and get `shader`."""
    normal, position = geometry.outputs["True Normal"], geometry.outputs["Position"]
    step = _step(graph, tables, length, position)
    leave = graph.node("ShaderNodeBsdfRayPortal", "to the outside")
    _colour(graph, leave, portal_volume.rgb(tables.entry.toon), weight)
    outside = graph.vector("SUBTRACT", "outside", position, graph.scale("a step", normal, step))
    graph.link(outside, leave.inputs["Position"])
    graph.link(normal, leave.inputs["Direction"])
    toon = graph.node("ShaderNodeBsdfToon", "light from outside")
    toon.component = "DIFFUSE"
    toon.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    toon.inputs["Size"].default_value = tables.entry.size
    toon.inputs["Smooth"].default_value = tables.entry.smooth
    limit = graph.math("MULTIPLY", "twice", step, 2.0)
    near = graph.math("LESS_THAN", "came from the step", light_path.outputs["Ray Length"], limit)
    front = mix_shader.between(graph, "from outside", near, shader, toon.outputs[0])
    return leave.outputs[0], front


def _colour(graph, node, colour, weight):
    """Set the color of a closure, times the socket `weight`."""
    graph.link(graph.vector("MULTIPLY", "weighted", weight, colour), node.inputs["Color"])


def _step(graph, tables, length, position):
    """Distance between the surface and the point outside: a small part of the profile, and above the rounding
    errors of the position."""
    away = graph.vector("LENGTH", "from the origin", position)
    far = graph.math("MULTIPLY_ADD", "rounding", away, ROUNDING, LEAST_STEP)
    return graph.math("MULTIPLY_ADD", "a step", length, STEP * float(np.median(tables.distance)), far)
