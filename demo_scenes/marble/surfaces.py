# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials whose inputs vary over the surface: values at the vertices, as attributes that the nodes read."""

import bpy
import node_tree
import numpy as np

from . import veins

LIT, COLOUR, RADIUS = "lit", "colour of stone", "radius of stone"
LEAST_IOR = 1.01  # of Cycles' node: practically a matched boundary
SHARES = np.linspace(0.0, 1.0, 33)  # of the vein, between which the stock node's colours are interpolated


def lit():
    """An Emission material with the radiance that `write` gives to the vertices under the name LIT."""
    material, tree, output = _new("lit")
    emission = tree.nodes.new("ShaderNodeEmission")
    _read(tree, LIT, emission.inputs["Color"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    return material


def polished(material, index, roughness):
    """`material` with the mirror-like reflection of a boundary of this index added; `roughness` is Blender's."""
    tree = material.node_tree
    output = tree.get_output_node("CYCLES")
    below = output.inputs["Surface"].links[0].from_socket
    fresnel, mix = tree.nodes.new("ShaderNodeFresnel"), tree.nodes.new("ShaderNodeMixShader")
    glossy, total = tree.nodes.new("ShaderNodeBsdfAnisotropic"), tree.nodes.new("ShaderNodeAddShader")
    fresnel.inputs["IOR"].default_value = index
    glossy.distribution = "GGX"
    glossy.inputs["Roughness"].default_value = roughness
    tree.links.new(fresnel.outputs[0], mix.inputs[0])
    tree.links.new(glossy.outputs[0], mix.inputs[2])
    tree.links.new(below, total.inputs[0])
    tree.links.new(mix.outputs[0], total.inputs[1])
    tree.links.new(total.outputs[0], output.inputs["Surface"])
    return material


def write(mesh, name, values):
    """Write `values` (n, 3) at the vertices as an attribute of the mesh."""
    attribute = mesh.attributes.get(name) or mesh.attributes.new(name, "FLOAT_VECTOR", "POINT")
    attribute.data.foreach_set("vector", np.asarray(values, np.float32).ravel())
    mesh.update_tag()


def stock(mesh, interior, points):
    """Subsurface Scattering as an artist sets it: Color is the reflectance of a deep body of the mixture at the point,
    Radius gives the walk the mixture's mean free path. `points`: the vertices (n, 3) in mm."""
    import lamina
    from lamina.subsurface import node_parameters

    sigma_s, sigma_a = interior.at(points)
    share = (sigma_a[:, 0] - veins.WHITE[1][0]) / (veins.VEIN[1][0] - veins.WHITE[1][0])
    colours = np.array([lamina.solve(lamina.Stack([], base=_deep(u)), quality="preview").reflectance("diffuse")
                        for u in SHARES])
    colour = np.stack([np.interp(share, SHARES, column) for column in colours.T], axis=1)
    radius = node_parameters.radius_of_path(1.0 / (sigma_s + sigma_a), 0.0, bpy.app.version[:2])
    material, tree, output = _new("stock")
    node = tree.nodes.new("ShaderNodeSubsurfaceScattering")
    node.falloff = "RANDOM_WALK"
    for name, value in (("Scale", 1.0), ("IOR", LEAST_IOR), ("Roughness", 0.0), ("Anisotropy", 0.0)):
        node.inputs[name].default_value = value
    write(mesh, COLOUR, colour)
    write(mesh, RADIUS, radius)
    _read(tree, COLOUR, node.inputs["Color"])
    _read(tree, RADIUS, node.inputs["Radius"])
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


def _deep(share):
    import lamina

    (s0, a0), (s1, a1) = np.array(veins.WHITE), np.array(veins.VEIN)
    return lamina.HalfSpace(sigma_s=(s0 + share * (s1 - s0)).tolist(), sigma_a=(a0 + share * (a1 - a0)).tolist())


def _new(name):
    material = bpy.data.materials.new(name)
    tree = node_tree.of(material)
    tree.nodes.clear()
    return material, tree, tree.nodes.new("ShaderNodeOutputMaterial")


def _read(tree, name, socket):
    """Let the socket read an attribute of the mesh."""
    node = tree.nodes.new("ShaderNodeAttribute")
    node.attribute_type, node.attribute_name = "GEOMETRY", name
    tree.links.new(node.outputs["Vector"], socket)
