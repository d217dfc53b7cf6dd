# SPDX-License-Identifier: GPL-3.0-or-later
"""A tabulated BSSRDF: Ray Portal BSDF, sources below the surface, and tables of lamina.portal_tables.

A camera ray that hits a front face continues from a source below the hit point, in a random upward direction.
The continued ray hits a back face. A Translucent closure there collects the light from outside. Rays are
weighted where they leave, by path length, depth of the source, and curvature.

A node cannot pass numbers from one hit to the next. The depth of the source is therefore a function of the
ray's direction in world space, which both hits know: the azimuth, folded many times onto the table. See
lamina.subsurface.portal for the equations."""

import math

import numpy as np

from ..base import data_image
from . import boundary_graph, portal_volume
from .expression import (
    arctangent,
    clamped,
    cosine,
    cross,
    dot,
    exponential,
    length,
    maximum,
    normalized,
    ping_pong,
    sine,
    sqrt,
)

# The step to the outside: a part of the mean exit distance, Blender units, and a part of the distance from
# the origin. Cycles misses the surface of a metre-wide face from 6e-6 units above; 1.3e-4 is enough.
STEP, LEAST_STEP, ROUNDING = 0.05, 6.0e-5, 3.0e-5
# Scale of the position for White Noise: about 1000 steps per millimetre give neighbours different numbers.
NOISE_SCALE = 917.3
# Times that half a turn of the azimuth runs through the depths: an even number, see _place_of_depth.
FOLDS = 64.0
# Rows of the image, from below; those by view cosine follow.
DEPTHS, VIEWS = 0, 1
ASIDE = (0.8017837, 0.2672612, 0.5345225)  # helper axis for the tangent frame; unlikely to equal a normal


def draw(graph, tables, unit, name):
    """Add the nodes and return (shader, volume). Without first orders the volume is None.

    `tables`: lamina.PortalTables; `unit`: the number of Blender units per millimetre, a value; `name`: of the
    image."""
    # Over the share of the views that take the portal, times the integral of the cosines' density.
    views = tables.views[:, None] * tables.shares * ((0.5 + tables.lift) / (1.0 - tables.entering))
    image = _image(name, tables.depths, views)
    geometry = graph.values(graph.node("ShaderNodeNewGeometry"))
    light_path = graph.values(graph.node("ShaderNodeLightPath"))
    chance = _chance(graph, geometry["Position"] * (NOISE_SCALE / unit))
    shader = _to_the_source(graph, tables, unit, geometry, image, chance)
    volume = None
    if tables.first is not None:
        shader, volume = portal_volume.with_volume(graph, tables, unit, light_path, shader, chance[1])
    weight, tilted = _weight_and_normal(graph, tables, image, unit, geometry, light_path)
    if tables.has_boundary:
        shader = boundary_graph.over(graph, tables.ior, tables.roughness, shader)
    return _by_side(graph, tables, unit, geometry, light_path, shader, volume, (weight, tilted)), volume


def _to_the_source(graph, tables, unit, geometry, image, chance):
    """The portal from the front face to the source."""
    normal = geometry["Normal"]
    # The cosine of the source's ray to the normal; the square of cosine + lift is uniform.
    lifted = sqrt(chance[0] * (1.0 + 2.0 * tables.lift) + tables.lift**2).named("cosine + lift")
    # A full turn for the random numbers that rays into the volume leave over.
    turn = 2.0 * math.pi / (1.0 - tables.entering)
    direction = _direction(normal, lifted - tables.lift, chance[1] * turn)
    place = _place_of_depth(graph, direction)
    depth = _depth(graph, image, place)
    seen = dot(normal, geometry["Incoming"]).named("view cosine")
    portal = graph.node("ShaderNodeBsdfRayPortal", "to the source")
    graph.link(_by_view(graph, image, place, seen) / lifted, portal.inputs["Color"])
    graph.link(geometry["Position"] - normal * (depth * unit), portal.inputs["Position"])
    graph.link(direction, portal.inputs["Direction"])
    return portal.outputs[0]


def _chance(graph, place):
    """Two random numbers, uniform in [0, 1), for the place of the shading point."""
    noise = graph.node("ShaderNodeTexWhiteNoise", "chance")
    noise.noise_dimensions = "3D"
    graph.link(place, noise.inputs["Vector"])
    return graph.separate("chance", noise.outputs["Color"])[:2]


def _direction(normal, height, azimuth):
    """The unit vector with the cosine `height` to the normal."""
    ring = sqrt(maximum(1.0 - height**2, 0.0)).named("sine")
    first = normalized(cross(normal, ASIDE)).named("first axis")
    second = cross(normal, first).named("second axis")
    level = first * (ring * cosine(azimuth)) + second * (ring * sine(azimuth))
    return (level + normal * height).named("direction")


def _place_of_depth(graph, direction):
    """Place in the table of depths, in [0, 1], of a ray that runs along `direction` or against it.

    Uniform if the azimuth is. The triangle wave has the period 2 / FOLDS half turns, so half a turn changes
    nothing."""
    parts = graph.node("ShaderNodeSeparateXYZ", "direction")
    graph.link(direction, parts.inputs[0])
    x, y, _ = map(graph.value, parts.outputs)
    return ping_pong(arctangent(y, x) * (FOLDS / math.pi), 1.0).named("place of the depth")


def _image(name, depths, views):
    """The image with `depths`, shape (count,), in its alpha channel, and `views`, (rows, count, channels)."""
    texels = np.ones((VIEWS + len(views), len(depths), 4), np.float32)
    texels[DEPTHS, :, 3] = depths
    texels[VIEWS:, :, :3] = views
    return data_image.create(name, texels)


def _depth(graph, image, place):
    """The depth at the place in [0, 1]: 0 is the first texel, 1 the last."""
    scale = (1.0 - 1.0 / image.size[0], 0.0)
    node = _texture(graph, image, DEPTHS, "depth of the source", place, "Closest", scale)
    return graph.value(node.outputs["Alpha"])


def _by_view(graph, image, place, cosine):
    """The weight of a ray by the place of its depth and by the view cosine."""
    width, height = image.size
    at = graph.combined("depth and view", place, cosine)
    # From [0, 1] to the centers of the first and the last row of views.
    scale = ((width - 1.0) / width, (height - VIEWS - 1.0) / height)
    node = _texture(graph, image, VIEWS, "by view and depth", at, "Linear", scale)
    return graph.value(node.outputs["Color"])


def _texture(graph, image, row, label, place, interpolation, scale):
    """The image at `place` times `scale` from the center of the first texel of a row."""
    node = graph.node("ShaderNodeTexImage", label)
    node.image, node.interpolation, node.extension = image, interpolation, "EXTEND"
    node.texture_mapping.scale = (*scale, 0.0)
    node.texture_mapping.translation = (0.5 / image.size[0], (row + 0.5) / image.size[1], 0.0)
    graph.link(place, node.inputs["Vector"])
    return node


def _by_side(graph, tables, unit, geometry, light_path, shader, volume, leaving):
    """The shader of both faces: on the back face, rays from the source show the light from outside, and the
    front face gets `shader`. `leaving`: weight and tilted normal where a ray leaves."""
    weight, tilted = leaving
    lit = graph.node("ShaderNodeBsdfTranslucent", "light from outside")
    graph.link(weight * portal_volume.rgb(tables.entry.diffuse), lit.inputs["Color"])
    graph.link(tilted, lit.inputs["Normal"])
    behind, front = lit.outputs[0], shader
    if tables.entry.toon.any():
        leave, front = _by_toon(graph, tables, unit, geometry, light_path, shader, weight)
        behind = graph.add_shaders("all that enters", behind, leave)
    if volume is not None:
        behind = portal_volume.behind(graph, light_path, behind)
    return graph.mix_shaders("from inside", geometry["Backfacing"], front, behind)


def _by_toon(graph, tables, unit, geometry, light_path, shader, weight):
    """The shaders (back face, front face) of light that enters as a Toon closure reflects it.

    Cycles cannot sample a Toon closure on a back face, so a part of the rays goes on to a point just outside,
    and back to the front face. There rays as short as that step show the Toon closure. All others are views
    and get `shader`."""
    normal, position = geometry["True Normal"], geometry["Position"]
    # A small part of the profile, and above the rounding errors of the position.
    far = length(position) * ROUNDING + LEAST_STEP
    step = (unit * (STEP * float(np.median(tables.distance))) + far).named("a step")
    leave = graph.node("ShaderNodeBsdfRayPortal", "to the outside")
    graph.link(weight * portal_volume.rgb(tables.entry.toon), leave.inputs["Color"])
    graph.link((position - normal * step).named("outside"), leave.inputs["Position"])
    graph.link(normal, leave.inputs["Direction"])
    toon = graph.node("ShaderNodeBsdfToon", "light from outside")
    toon.component = "DIFFUSE"
    toon.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    toon.inputs["Size"].default_value = tables.entry.size
    toon.inputs["Smooth"].default_value = tables.entry.smooth
    near = (light_path["Ray Length"] < step * 2.0).named("came from the step")
    front = graph.mix_shaders("from outside", near, shader, toon.outputs[0])
    return leave.outputs[0], front


def _weight_and_normal(graph, tables, image, unit, geometry, light_path):
    """(weight of a ray, a colour; normal of the closure) at the back face where the ray leaves.

    `tables`: lamina.PortalTables; `unit`: the Blender units per millimetre; `geometry`, `light_path`: the
    values of the nodes by name."""
    incoming = geometry["Incoming"]
    cosine = dot(incoming, geometry["True Normal"]).named("exit cosine")
    depth = _depth(graph, image, _place_of_depth(graph, incoming))
    way = (light_path["Ray Length"] / unit).named("path length, mm")
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
