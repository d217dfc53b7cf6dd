# SPDX-License-Identifier: GPL-3.0-or-later
"""Which nodes have a value inside an object, and which nodes count: those that lead to the chosen output."""

import bpy
import pytest

# All other nodes of Blender 4.3 to 5.2 whose values follow from a position, or are the same everywhere.
KNOWN = {
    "BLACKBODY", "BRIGHTCONTRAST", "CLAMP", "COMBHSV", "COMBINE_COLOR", "COMBRGB", "COMBXYZ", "CURVE_FLOAT",
    "CURVE_RGB", "CURVE_VEC", "GAMMA", "GROUP", "GROUP_INPUT", "HUE_SAT", "INVERT", "MAPPING", "MAP_RANGE", "MATH",
    "MIX", "MIX_RGB", "NORMAL", "REROUTE", "RGB", "RGBTOBW", "SEPARATE_COLOR", "SEPHSV", "SEPRGB", "SEPXYZ",
    "SQUEEZE", "TEX_BRICK", "TEX_CHECKER", "TEX_COORD", "TEX_GABOR", "TEX_GRADIENT", "TEX_MAGIC", "TEX_NOISE",
    "TEX_SKY", "TEX_VORONOI", "TEX_WAVE", "TEX_WHITE_NOISE", "VALTORGB", "VALUE", "VECTOR_ROTATE", "VECT_MATH",
    "VECT_TRANSFORM", "WAVELENGTH", "NodeClosureInput", "NodeClosureOutput", "NodeCombineBundle",
    "NodeEvaluateClosure", "NodeImplicitConversion", "NodeJoinBundle", "NodeSeparateBundle", "ShaderNodeRadialTiling",
}  # fmt: skip


@pytest.fixture
def sources(addon):
    from bl_ext.user_default.lamina.interior import node_sources

    return node_sources


@pytest.fixture
def tree(material):
    return material.node_tree


@pytest.fixture
def find(sources, material):
    """find(socket): that socket, or RefusedError"""
    return lambda socket: sources.find_source(material.node_tree, (socket.node.name, socket.identifier), material)


def add(tree, kind, vector=None):
    """A new node, with this output of Texture Coordinate linked to its first input."""
    node = tree.nodes.new(f"ShaderNode{kind}")
    if vector:
        tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs[vector], node.inputs[0])
    return node


def grouped(tree, kind, vector):
    """A group node: its first output is a node on the group's input, and its second the place in the scene."""
    inner = bpy.data.node_groups.new("Inner", "ShaderNodeTree")
    inner.interface.new_socket("Vector", in_out="INPUT", socket_type="NodeSocketVector")
    for name in ("Value", "Place"):
        inner.interface.new_socket(name, in_out="OUTPUT", socket_type="NodeSocketVector")
    node, first, last = add(inner, kind), inner.nodes.new("NodeGroupInput"), inner.nodes.new("NodeGroupOutput")
    inner.links.new(first.outputs[0], node.inputs[0])
    inner.links.new(node.outputs[0], last.inputs["Value"])
    inner.links.new(add(inner, "NewGeometry").outputs["Position"], last.inputs["Place"])
    group = tree.nodes.new("ShaderNodeGroup")
    group.node_tree = inner
    if vector:
        tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs[vector], group.inputs[0])
    return group


def test_every_node_is_known(sources, find, tree):
    """A node that a new Blender brings must be judged before it is accepted."""
    unknown = []
    for name in dir(bpy.types):
        kind = getattr(bpy.types, name)
        if name.startswith(("ShaderNode", "Node")) and issubclass(kind, bpy.types.Node):
            try:
                node = tree.nodes.new(name)
            except RuntimeError:  # not a node of materials
                continue
            plain = [socket for socket in node.outputs if socket.type != "SHADER"]
            if plain and node.type not in KNOWN:
                try:
                    find(plain[0])
                    unknown.append(node.type)
                except sources.RefusedError:
                    pass
    assert len(tree.nodes) > 90 and not unknown


@pytest.mark.parametrize(("kind", "words"), [
    ("TexImage", "Bronze: node Image Texture has no Vector and so takes the UV map: use the Object or Generated"),
    ("TexEnvironment", "node Environment Texture has no Vector and so takes the place in the scene"),
    ("TexIES", "node IES Texture has no Vector and so takes the direction of the ray"),
    ("LightFalloff", "node Light Falloff has no value inside the object"),
    ("Displacement", "node Displacement has no value inside the object"),
    ("ShaderToRGB", "node Shader to RGB has no value inside the object"),
    ("VectorTransform", "Vector Transform converts from world to object space, but an interior moves with its object"),
])  # fmt: skip
def test_values_of_a_surface_a_ray_or_the_scene(sources, find, tree, kind, words):
    with pytest.raises(sources.RefusedError, match=words):
        find(add(tree, kind).outputs[0])


def test_an_image_in_object_coordinates(sources, find, tree):
    """But not projected by Box, along normals, and not where the link is muted."""
    image = add(tree, "TexImage", "Object")
    assert find(image.outputs[0]) == image.outputs[0]
    image.projection = "BOX"
    with pytest.raises(sources.RefusedError, match="projects by Box, .*: choose another projection"):
        find(image.outputs[0])
    image.projection = "FLAT"
    image.inputs["Vector"].links[0].is_muted = True
    with pytest.raises(sources.RefusedError, match="has no Vector"):
        find(image.outputs[0])


def test_an_image_behind_a_reroute(sources, find, tree):
    image, reroute = add(tree, "TexImage"), tree.nodes.new("NodeReroute")
    tree.links.new(reroute.outputs[0], image.inputs["Vector"])
    with pytest.raises(sources.RefusedError, match="has no Vector"):
        find(image.outputs[0])
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"], reroute.inputs[0])
    assert find(image.outputs[0])


def test_only_outputs_that_lead_to_the_chosen_one_count(sources, find, tree):
    """One Texture Coordinate node may also give UV to something else."""
    noise = add(tree, "TexNoise", "Object")
    shared = noise.inputs[0].links[0].from_node
    image = add(tree, "TexImage")
    tree.links.new(shared.outputs["UV"], image.inputs["Vector"])
    assert find(noise.outputs[0]) == noise.outputs[0]
    with pytest.raises(sources.RefusedError, match="Texture Coordinate gives UV"):
        find(image.outputs[0])
    shared.object = bpy.data.objects.new("Handle", None)
    with pytest.raises(sources.RefusedError, match="gives the coordinates of Handle"):
        find(noise.outputs[0])


@pytest.mark.parametrize(("kind", "vector", "output", "words"), [
    ("TexImage", "Object", "Value", ""),
    ("TexImage", "UV", "Value", "Texture Coordinate gives UV"),
    ("TexImage", None, "Value", "Image Texture has no Vector"),
    ("TexNoise", None, "Value", ""),
    ("TexImage", "Object", "Place", "node Geometry has no value"),
])  # fmt: skip
def test_groups(sources, find, tree, kind, vector, output, words):
    socket = grouped(tree, kind, vector).outputs[output]
    if words:
        with pytest.raises(sources.RefusedError, match=words):
            find(socket)
    else:
        assert find(socket) == socket


def test_a_muted_node_passes_its_input_on(sources, find, tree):
    mapping = add(tree, "Mapping", "Object")
    tree.links.new(add(tree, "NewGeometry").outputs["Position"], mapping.inputs["Location"])
    with pytest.raises(sources.RefusedError, match="node Geometry"):
        find(mapping.outputs[0])
    mapping.mute = True
    assert find(mapping.outputs[0])
