# SPDX-License-Identifier: GPL-3.0-or-later
"""A tabulated BSSRDF: Ray Portal BSDF, sources below the surface, and tables of lamina.portal_tables.

A camera ray that hits a front face continues from a source below the hit point, in a random upward direction.
The continued ray hits a back face. A Translucent closure there collects the light from outside. Rays are
weighted where they leave (portal_exit)."""

import math

import numpy as np

from . import boundary_graph, mix_shader, portal_exit, portal_image, portal_volume
from .expression import cosine, cross, dot, length, maximum, normalized, sine, sqrt

# The step to the outside: a part of the mean exit distance, Blender units, and a part of the distance from
# the origin. Cycles misses the surface of a metre-wide face from 6e-6 units above; 1.3e-4 is enough.
STEP, LEAST_STEP, ROUNDING = 0.05, 6.0e-5, 3.0e-5
# Scale of the position for White Noise: about 1000 steps per millimetre give neighbours different numbers.
NOISE_SCALE = 917.3
ASIDE = (0.8017837, 0.2672612, 0.5345225)  # helper axis for the tangent frame; unlikely to equal a normal


def draw(graph, tables, unit, name):
    """Add the nodes and return (shader, volume). Without first orders the volume is None.

    `tables`: lamina.PortalTables; `unit`: the number of Blender units per millimetre, a value; `name`: of the
    image."""
    # Over the share of the views that take the portal, times the integral of the cosines' density.
    views = tables.views[:, None] * tables.shares * ((0.5 + tables.lift) / (1.0 - tables.entering))
    image = portal_image.create(name, tables.depths, views)
    geometry = graph.values(graph.node("ShaderNodeNewGeometry"))
    light_path = graph.values(graph.node("ShaderNodeLightPath"))
    chance = _chance(graph, geometry["Position"] * (NOISE_SCALE / unit))
    shader = _to_the_source(graph, tables, unit, geometry, image, chance)
    volume = None
    if tables.first is not None:
        shader, volume = portal_volume.with_volume(graph, tables, unit, light_path, shader, chance[1])
    weight, tilted = portal_exit.weight_and_normal(graph, tables, image, unit, geometry, light_path)
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
    place = portal_exit.place_of_depth(graph, direction)
    depth = portal_image.depth(graph, image, place)
    seen = dot(normal, geometry["Incoming"]).named("view cosine")
    portal = graph.node("ShaderNodeBsdfRayPortal", "to the source")
    graph.link(portal_image.by_view(graph, image, place, seen) / lifted, portal.inputs["Color"])
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
        behind = mix_shader.added(graph, "all that enters", behind, leave)
    if volume is not None:
        behind = portal_volume.behind(graph, light_path, behind)
    return mix_shader.between(graph, "from inside", geometry["Backfacing"], front, behind)


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
    front = mix_shader.between(graph, "from outside", near, shader, toon.outputs[0])
    return leave.outputs[0], front
