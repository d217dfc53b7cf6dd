# SPDX-License-Identifier: GPL-3.0-or-later
"""What is read from a Principled BSDF: where it is, its values, and what layers cannot carry."""

import bpy
import pytest
from artists_trees import TREES, make

WITHOUT = {"cut out", "two principled", "glow added", "glass", "hair", "classic", "own group", "muted output link",
           "muted principled", "no output", "nothing linked", "no nodes"}
if bpy.app.version < (5, 0):  # from 5.0 on the nodes of a material cannot be switched off
    WITHOUT.add("nodes off")

LOST = {
    "default": [],
    "metal": [],
    "coated": [],
    "normal map": [],
    "gltf alpha": [],
    "obj": ["texture of Specular IOR Level (the number 0.5 is used instead)"],
    "glow": ["dimming of the emission (it shines above the layers)"],
    "everything": ["subsurface scattering", "transmission", "sheen", "thin film",
                   "anisotropic highlights for light that the layers scatter, and below interfaces",
                   "tint of the specular highlights", "tint of the coat"],
}


@pytest.mark.parametrize("name", TREES)
def test_found_where_it_alone_feeds_the_output(addon, name):
    node = addon.nodes.principled.find(make(addon, name))
    assert (node is None) == (name in WITHOUT)
    if name == "several principled":
        assert node.inputs["Roughness"].default_value == pytest.approx(0.5)


@pytest.mark.parametrize("name", LOST)
def test_what_is_lost_is_named(addon, name):
    assert addon.nodes.principled.not_carried(addon.nodes.principled.find(make(addon, name))) == LOST[name]


INPUTS = {
    "numbers": set(), "texture": {"color"}, "painted maps": {"color", "metallic", "roughness"},
    "muted texture link": set(), "empty reroute": set(), "reroutes": {"color"}, "animated": {"color", "roughness"},
    "driven": {"metallic"}, "muted nodes": {"color"}, "gltf": {"color", "metallic", "roughness"},
}


@pytest.mark.parametrize("name", INPUTS)
def test_textures_and_animations_become_inputs(addon, name):
    assert addon.nodes.principled.inputs(addon.nodes.principled.find(make(addon, name))) == INPUTS[name]


@pytest.fixture
def node(addon):
    return addon.nodes.principled.find(make(addon, "default"))


def lost(addon, node, **values):
    for name, value in values.items():
        node.inputs[name.replace("_", " ")].default_value = value
    return addon.nodes.principled.not_carried(node)


def test_parts_without_effect_are_not_named(addon, node):
    white, red = (1.0, 1.0, 1.0, 1.0), (1.0, 0.0, 0.0, 1.0)
    assert lost(addon, node, Coat_Tint=red, Coat_Weight=0.0) == []
    assert lost(addon, node, Coat_Weight=0.5) == ["tint of the coat"]
    assert lost(addon, node, Coat_Tint=white) == []
    assert lost(addon, node, Coat_Weight=0.0, Transmission_Weight=1.0, Metallic=1.0) == []
    assert lost(addon, node, Transmission_Weight=1.0, Metallic=0.5) == ["transmission"]
    assert lost(addon, node, Transmission_Weight=0.0, Emission_Strength=2.0, Emission_Color=(0, 0, 0, 1)) == []


def test_the_coat_has_the_normal_of_the_surface(addon, node):
    tree, told = node.id_data, ["normal of the coat (that of the surface is used)"]
    tree.links.new(tree.nodes.new("ShaderNodeBump").outputs[0], node.inputs["Normal"])
    assert lost(addon, node) == []
    assert lost(addon, node, Coat_Weight=0.5) == told
    tree.links.new(node.inputs["Normal"].links[0].from_socket, node.inputs["Coat Normal"])
    assert lost(addon, node) == []
    tree.links.remove(node.inputs["Normal"].links[0])
    assert lost(addon, node) == told


def test_ggx_and_emission_below_a_rough_coat_are_named(addon, node):
    node.distribution = "GGX"
    assert [text.split(" for ")[0] for text in lost(addon, node)] == ["distribution GGX"]
    node.distribution = "MULTI_GGX"
    lost(addon, node, Emission_Strength=1.0, Emission_Color=(1.0, 1.0, 1.0, 1.0), Coat_Weight=1.0)
    assert len(lost(addon, node, Coat_Roughness=0.05)) == 1
    assert lost(addon, node, Coat_Roughness=0.2)[1].startswith("roughness of the coat for the emission")


def test_a_number_out_of_range_is_named_and_clipped(addon, node):
    assert lost(addon, node, Base_Color=(2.0, 0.5, 0.5, 1.0)) == ["Base Color 2, 0.5, 0.5 (must lie in [0, 1])"]
    assert addon.nodes.principled.values(node)["color"] == (1.0, 0.5, 0.5)


def test_a_texture_of_anisotropy_is_named(addon, node):
    tree = node.id_data
    assert lost(addon, node, Anisotropic=0.5)[0].startswith("anisotropic highlights for light that")
    assert addon.nodes.principled.anisotropy(node) == [0.5, 0.0]
    tree.links.new(tree.nodes.new("ShaderNodeTexNoise").outputs[0], node.inputs["Anisotropic Rotation"])
    assert lost(addon, node) == ["anisotropic highlights"]
    assert addon.nodes.principled.anisotropy(node) == [0.0, 0.0]


def test_a_linked_or_animated_number_is_named(addon, node):
    node.inputs["IOR"].default_value = 1.4
    node.inputs["IOR"].keyframe_insert("default_value", frame=1)
    texts = ["animation of IOR (the number 1.4 is used instead)"]
    assert addon.nodes.principled.not_carried(node) == texts
    noise = node.id_data.nodes.new("ShaderNodeTexNoise")
    node.id_data.links.new(noise.outputs[0], node.inputs["Sheen Weight"])
    assert addon.nodes.principled.not_carried(node) == ["sheen", *texts]
    node.inputs["Sheen Weight"].links[0].is_muted = True
    assert addon.nodes.principled.not_carried(node) == texts


def test_every_socket_of_the_base_is_a_socket_of_the_node(addon, node):
    reader = addon.nodes.principled
    names = [field.name for field in addon.kinds.bases.PrincipledBase.fields]
    assert list(reader.SOCKETS) == names
    values = reader.values(bpy.data.materials["default"].node_tree.nodes["Principled BSDF"])
    assert values["color"] == pytest.approx((0.8, 0.8, 0.8)) and values["roughness"] == pytest.approx(0.5)
    assert values["ior"] == pytest.approx(1.5) and values["coat_roughness"] == pytest.approx(0.03)
