# SPDX-License-Identifier: GPL-3.0-or-later
"""A tabulated BSSRDF: Ray Portal BSDF, sources below the surface, and tables of lamina.portal_tables.

A camera ray that hits a front face continues from a source below the hit point, in a random upward direction.
The continued ray hits a back face. A Translucent closure there collects the light from outside."""

import math

import numpy as np

from ..base import data_image
from . import boundary_graph, mix_shader, portal_volume

# The step to the outside: a part of the tables' scale, Blender units, and a part of the distance from the
# origin. Cycles misses the surface of a metre-wide face from 6e-6 units above; 1.3e-4 is enough.
STEP, LEAST_STEP, ROUNDING = 0.05, 6.0e-5, 3.0e-5
# Rows of the image, from below.
DEPTHS, WEIGHTS, VIEWS, ROWS = 0, 1, 2, 4
# Scale of the position for White Noise: about 1000 steps per millimetre give neighbours different numbers.
NOISE_SCALE = 917.3
ASIDE = (0.8017837, 0.2672612, 0.5345225)  # helper axis for the tangent frame; unlikely to equal a normal


def draw(graph, tables, length, name):
    """Add the nodes and return the sockets (shader, volume). Without single scattering the volume is None.

    `tables`: lamina.PortalTables; `length`: the socket with the number of Blender units per millimetre;
    `name`: name of the image."""
    image = data_image.create(name, _texels(tables))
    geometry = graph.node("ShaderNodeNewGeometry", -3, 4)
    light_path = graph.node("ShaderNodeLightPath", -3, 10)
    chance = _chance(graph, geometry.outputs["Position"], length)
    shader = _to_the_source(graph, tables, length, geometry, image, chance)
    volume = None
    if tables.single is not None:
        shader, volume = portal_volume.with_volume(graph, tables, length, light_path, shader, chance[2])
    if tables.has_boundary:
        shader = boundary_graph.over(graph, tables.ior, tables.roughness, shader)
    return _by_side(graph, tables, length, geometry, light_path, shader, volume), volume


def _to_the_source(graph, tables, length, geometry, image, chance):
    """The portal from the front face to the source."""
    normal = geometry.outputs["Normal"]
    depth = _row(graph, image, DEPTHS, "depth of the source, mm", chance[0], "Closest").outputs["Color"]
    cosine, sine = _cosine(graph, chance[1])
    out = graph.math("DIVIDE", 0, 8, "over depth", sine, cosine)
    r = graph.math("MULTIPLY", 1, 8, "distance on a plane", out, depth)
    place = graph.math("DIVIDE", 2, 8, "place", r, graph.math("ADD", 1, 9, "and scale", r, tables.scale))
    weight = _row(graph, image, WEIGHTS, "weight", place, "Linear").outputs["Color"]
    seen = graph.vector("DOT_PRODUCT", 0, 12, "view cosine", normal, geometry.outputs["Incoming"])
    colour = _row(graph, image, VIEWS, "light through the portal", seen, "Linear").outputs["Color"]
    portal = graph.node("ShaderNodeBsdfRayPortal", 4, 6, "to the source")
    graph.link(graph.vector("MULTIPLY", 3, 10, "colour", colour, weight), portal.inputs["Color"])
    way = graph.math("MULTIPLY", 1, 5, "depth of the source", depth, length)
    below = graph.scale(2, 5, "down", normal, way)
    source = graph.vector("SUBTRACT", 3, 5, "source", geometry.outputs["Position"], below)
    graph.link(source, portal.inputs["Position"])
    # A full turn for the random numbers that rays into the volume leave over.
    turn = 2.0 * math.pi / _share(tables)
    graph.link(_direction(graph, normal, cosine, sine, chance[2], turn), portal.inputs["Direction"])
    return portal.outputs[0]


def _texels(tables):
    """The tables as rows of an image, with values at texel centres."""
    width = len(tables.depths)
    texels = np.zeros((ROWS, width, 4), np.float32)
    texels[:, :, 3] = 1.0
    texels[DEPTHS, :, :3] = tables.depths[:, None]
    for row, values in ((WEIGHTS, tables.weights), (VIEWS, tables.views / _share(tables))):
        places = np.linspace(0.0, len(values) - 1.0, width)
        wide = np.stack([np.interp(places, np.arange(len(values)), column) for column in values.T], axis=1)
        texels[row, :, :3] = wide
    return texels


def _share(tables):
    """Share of the views that take the portal."""
    return 1.0 if tables.single is None else 1.0 - portal_volume.ENTERING


def _row(graph, image, row, label, place, interpolation):
    """Look up a row of the image at a coordinate in [0, 1]: 0 is the first texel, 1 the last."""
    width = image.size[0]
    half = 0.5 / width
    at = graph.node("ShaderNodeCombineXYZ", 2, 2 * row, label)
    line = graph.math("MULTIPLY_ADD", 1, 2 * row, "to texels", place, 1.0 - 2.0 * half, half)
    graph.link(line, at.inputs[0])
    at.inputs[1].default_value = (row + 0.5) / ROWS
    node = graph.node("ShaderNodeTexImage", 3, 2 * row, label)
    node.image, node.interpolation, node.extension = image, interpolation, "EXTEND"
    graph.link(at.outputs[0], node.inputs["Vector"])
    return node


def _chance(graph, position, length):
    """Three random numbers, uniform in [0, 1), for the shading point."""
    fine = graph.math("DIVIDE", -2, 6, "steps", NOISE_SCALE, length)
    noise = graph.node("ShaderNodeTexWhiteNoise", -1, 6, "chance")
    noise.noise_dimensions = "3D"
    graph.link(graph.scale(-2, 7, "in steps", position, fine), noise.inputs["Vector"])
    parts = graph.node("ShaderNodeSeparateColor", 0, 6, "chance")
    graph.link(noise.outputs["Color"], parts.inputs[0])
    return tuple(parts.outputs)[:3]


def _cosine(graph, chance):
    """(cosine, sine) of the angle between the source's ray and the normal: uniform over the hemisphere."""
    cosine = graph.math("MAXIMUM", 0, 7, "cosine", chance, 1.0e-6)
    square = graph.math("MULTIPLY", 1, 7, "square", cosine, cosine)
    return cosine, graph.math("SQRT", 3, 7, "sine", graph.math("SUBTRACT", 2, 7, "rest", 1.0, square))


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


def _by_side(graph, tables, length, geometry, light_path, shader, volume):
    """The shader of both faces.

    Back face: rays from the source show the light from outside, by a Translucent closure. Cycles cannot
    sample a Toon closure there, so a part of the rays goes on to a point just outside, and back to the front
    face. Front face: rays as short as that step show the Toon closure. All others are views and get
    `shader`."""
    normal, position = geometry.outputs["True Normal"], geometry.outputs["Position"]
    step = _step(graph, tables, length, position)
    leave = graph.node("ShaderNodeBsdfRayPortal", 6, 8, "to the outside")
    leave.inputs["Color"].default_value = (*portal_volume.rgb(tables.entry.toon), 1.0)
    outside = graph.vector("SUBTRACT", 5, 9, "outside", position, graph.scale(4, 9, "a step", normal, step))
    graph.link(outside, leave.inputs["Position"])
    graph.link(normal, leave.inputs["Direction"])
    lit = graph.node("ShaderNodeBsdfTranslucent", 6, 9, "light from outside")
    lit.inputs["Color"].default_value = (*portal_volume.rgb(tables.entry.diffuse), 1.0)
    behind = mix_shader.added(graph, 7, 9, "all that enters", lit.outputs[0], leave.outputs[0])
    if volume is not None:
        behind = portal_volume.behind(graph, light_path, behind)
    toon = graph.node("ShaderNodeBsdfToon", 4, 15, "light from outside")
    toon.component = "DIFFUSE"
    toon.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    toon.inputs["Size"].default_value = tables.entry.size
    toon.inputs["Smooth"].default_value = tables.entry.smooth
    limit = graph.math("MULTIPLY", 4, 12, "twice", step, 2.0)
    near = graph.math("LESS_THAN", 5, 12, "came from the step", light_path.outputs["Ray Length"], limit)
    front = mix_shader.between(graph, 6, 6, "from outside", near, shader, toon.outputs[0])
    return mix_shader.between(graph, 7, 6, "from inside", geometry.outputs["Backfacing"], front, behind)


def _step(graph, tables, length, position):
    """Distance between the surface and the point outside: a small part of the profile, and above the rounding
    errors of the position."""
    away = graph.vector("LENGTH", 2, 12, "from the origin", position)
    far = graph.math("MULTIPLY_ADD", 3, 12, "rounding", away, ROUNDING, LEAST_STEP)
    return graph.math("MULTIPLY_ADD", 4, 11, "a step", length, STEP * tables.scale, far)
