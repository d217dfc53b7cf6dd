# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that is scattered a few times, by Cycles' volume rendering, in addition to the portal.

A part of the views enters the volume through a Refraction closure of index 1. From then on the ray has an odd
number of transmissions, while a ray of the portal has an even number. The volume and the back faces tell the
two kinds by this number. Cycles does not count scatterings in volumes for nodes, but counts all bounces and
those at surfaces, and the difference is the number of scatterings. Views that arrive with an odd number of
transmissions, as through a single refracting face, or that a volume has scattered before, as in fog, get a
Diffuse closure with the material's albedo instead."""

import numpy as np

from . import mix_shader


def with_volume(graph, tables, length, light_path, portal, chance):
    """The sockets (shader, volume) of `portal` together with the first orders of scattering.

    `tables`: lamina.PortalTables; `length`: socket with the Blender units per millimetre; `chance`: socket
    with a random number in [0, 1). Where `chance` is at least `tables.entering`, the portal is used, which
    must be weighted with 1 / (1 - tables.entering)."""
    inside = _is_inside(graph, light_path)
    scatterings = _scatterings(graph, light_path)
    enter = graph.node("ShaderNodeBsdfRefraction", "into the volume")
    enter.inputs["Color"].default_value = (1.0 / tables.entering,) * 3 + (1.0,)
    enter.inputs["IOR"].default_value, enter.inputs["Roughness"].default_value = 1.0, 0.0
    local = graph.node("ShaderNodeBsdfDiffuse", "seen through one face")
    local.inputs["Color"].default_value = (*rgb(tables.albedo), 1.0)
    chosen = graph.math("LESS_THAN", "enters", chance, tables.entering)
    shader = mix_shader.between(graph, "volume or portal", chosen, portal, enter.outputs[0])
    indirect = graph.math("MAXIMUM", "or scattered before", inside, scatterings)
    shader = mix_shader.between(graph, "seen through one face", indirect, shader, local.outputs[0])
    return shader, _volume(graph, tables.first, length, light_path, inside, scatterings)


def behind(graph, light_path, portal):
    """The shader of back faces: transparent from the volume, `portal` for the rays of the portal."""
    through = graph.node("ShaderNodeBsdfTransparent", "out of the volume")
    through.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    inside = _is_inside_or_shadow(graph, light_path, _is_inside(graph, light_path))
    return mix_shader.between(graph, "volume or portal", inside, portal, through.outputs[0])


def _volume(graph, first, length, light_path, inside, scatterings):
    """Rays that were scattered `first.count` times are not scattered again: for them the volume only
    absorbs."""
    medium = first.medium
    here = _is_inside_or_shadow(graph, light_path, inside)
    dense = graph.math("DIVIDE", "in Blender units", here, length)
    largest = float(np.max(medium.extinction))
    density = graph.math("MULTIPLY", "density", dense, largest)
    scatter = graph.node("ShaderNodeVolumeScatter", "scattered")
    absorb = graph.node("ShaderNodeVolumeAbsorption", "absorbed")
    done = graph.math("GREATER_THAN", "not scattered again", scatterings, first.count - 0.5)
    more = graph.math("SUBTRACT", "scattered again", 1.0, done)
    graph.link(graph.math("MULTIPLY", "density", density, more), scatter.inputs["Density"])
    scatter.inputs["Color"].default_value = (*rgb(medium.sigma_s / largest), 1.0)
    scatter.inputs["Anisotropy"].default_value = medium.g
    lost = graph.node("ShaderNodeVectorMath", "all that is lost")
    lost.operation = "MULTIPLY_ADD"
    graph.link(done, lost.inputs[0])
    # The closure absorbs its density times (1 - colour).
    lost.inputs[1].default_value = rgb(-medium.sigma_s / largest)
    lost.inputs[2].default_value = rgb(1.0 - medium.sigma_a / largest)
    graph.link(lost.outputs["Vector"], absorb.inputs["Color"])
    graph.link(density, absorb.inputs["Density"])
    return mix_shader.added(graph, "the volume", scatter.outputs[0], absorb.outputs[0])


def _scatterings(graph, light_path):
    """Number of scatterings of the ray in volumes."""
    depth = light_path.outputs
    faces = graph.math("ADD", "", depth["Diffuse Depth"], depth["Glossy Depth"])
    faces = graph.math("ADD", "bounces at surfaces", faces, depth["Transmission Depth"])
    return graph.math("SUBTRACT", "scatterings", depth["Ray Depth"], faces)


def _is_inside(graph, light_path):
    """1 for rays in the volume, 0 for all others."""
    return graph.math("MODULO", "odd transmissions", light_path.outputs["Transmission Depth"], 2.0)


def _is_inside_or_shadow(graph, light_path, inside):
    return graph.math("MAXIMUM", "or shadow", inside, light_path.outputs["Is Shadow Ray"])


def rgb(values):
    """Three numbers, from one or three."""
    return tuple(float(value) for value in np.broadcast_to(values, 3))
