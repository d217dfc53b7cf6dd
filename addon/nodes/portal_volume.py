# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that is scattered a few times, by Cycles' volume rendering, in addition to the portal.

A part of the views enters the volume through a Refraction closure of index 1. From then on the ray has an odd
number of transmissions, while a ray of the portal has an even number. The volume and the back faces tell the
two kinds by this number. Cycles does not count scatterings in volumes for nodes, but counts all bounces and
those at surfaces, and the difference is the number of scatterings. Views that arrive with an odd number of
transmissions, as through a single refracting face, or that a volume has scattered before, as in fog, get a
Diffuse closure with the material's albedo instead."""

import numpy as np

from .expression import maximum, modulo


def with_volume(graph, tables, unit, light_path, portal, chance):
    """(shader, volume) of `portal` together with the first orders of scattering.

    `tables`: lamina.PortalTables; `unit`: the Blender units per millimetre; `chance`: a random number
    in [0, 1). Where `chance` is at least `tables.entering`, the portal is used, which must be weighted with
    1 / (1 - tables.entering)."""
    inside = _is_inside(light_path)
    faces = light_path["Diffuse Depth"] + light_path["Glossy Depth"] + light_path["Transmission Depth"]
    scatterings = (light_path["Ray Depth"] - faces).named("scatterings")
    enter = graph.node("ShaderNodeBsdfRefraction", "into the volume")
    enter.inputs["Color"].default_value = (1.0 / tables.entering,) * 3 + (1.0,)
    enter.inputs["IOR"].default_value, enter.inputs["Roughness"].default_value = 1.0, 0.0
    local = graph.node("ShaderNodeBsdfDiffuse", "seen through one face")
    local.inputs["Color"].default_value = (*rgb(tables.albedo), 1.0)
    chosen = (chance < tables.entering).named("enters")
    shader = graph.mix_shaders("volume or portal", chosen, portal, enter.outputs[0])
    indirect = maximum(inside, scatterings).named("or scattered before")
    shader = graph.mix_shaders("seen through one face", indirect, shader, local.outputs[0])
    here = _or_shadow(light_path, inside)
    return shader, _volume(graph, tables.first, unit, here, scatterings)


def behind(graph, light_path, portal):
    """The shader of back faces: transparent from the volume, `portal` for the rays of the portal."""
    through = graph.node("ShaderNodeBsdfTransparent", "out of the volume")
    through.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    inside = _or_shadow(light_path, _is_inside(light_path))
    return graph.mix_shaders("volume or portal", inside, portal, through.outputs[0])


def _volume(graph, first, unit, here, scatterings):
    """The volume, where `here` is 1. Rays that were scattered `first.count` times are not scattered again:
    for them the volume only absorbs."""
    medium = first.medium
    largest = float(np.max(medium.extinction))
    density = (here / unit * largest).named("density")
    scatter = graph.node("ShaderNodeVolumeScatter", "scattered")
    absorb = graph.node("ShaderNodeVolumeAbsorption", "absorbed")
    done = (scatterings > first.count - 0.5).named("not scattered again")
    graph.link(density * (1.0 - done), scatter.inputs["Density"])
    scatter.inputs["Color"].default_value = (*rgb(medium.sigma_s / largest), 1.0)
    scatter.inputs["Anisotropy"].default_value = medium.g
    # The closure absorbs its density times (1 - colour).
    lost = done * rgb(-medium.sigma_s / largest) + rgb(1.0 - medium.sigma_a / largest)
    graph.link(lost.named("all that is lost"), absorb.inputs["Color"])
    graph.link(density, absorb.inputs["Density"])
    return graph.add_shaders("the volume", scatter.outputs[0], absorb.outputs[0])


def _is_inside(light_path):
    """1 for rays in the volume, 0 for all others."""
    return modulo(light_path["Transmission Depth"], 2.0).named("odd transmissions")


def _or_shadow(light_path, inside):
    return maximum(inside, light_path["Is Shadow Ray"]).named("or shadow")


def rgb(values):
    """Three numbers, from one or three."""
    return tuple(float(value) for value in np.broadcast_to(values, 3))
