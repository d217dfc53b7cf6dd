# SPDX-License-Identifier: GPL-3.0-or-later
"""The tangent of anisotropic materials: the group's input, and the node that the panel's choice adds."""

import bpy
import pytest
import serialised_tree

BRUSHED = {"schema": 1, "layers": [], "base": {"kind": "conductor", "eta": 0.2, "k": 3.0, "alpha": 0.1, "alpha_v": 0.3}}
PLAIN = {**BRUSHED, "base": {"kind": "conductor", "eta": 0.2, "k": 3.0, "alpha": 0.1}}


@pytest.fixture
def show(addon, lamina, material, tables):
    """show(data): the material shows this stack; returns the node with its group."""

    def show(data):
        addon.editing.stack_io.assign(material, data)
        key = str(data)
        if key not in tables:
            tables[key] = lamina.bake(addon.editing.stack_io.to_stack(material), "preview", basis="moving")
        addon.baking.bake_job.apply(material, tables[key])
        return next(node for node in material.node_tree.nodes if node.type == "GROUP")

    return show


def tangents(material):
    return [node for node in material.node_tree.nodes if node.type == "TANGENT"]


def test_the_input_comes_and_goes_with_the_anisotropy(show):
    assert "Tangent" in show(BRUSHED).inputs
    assert "Tangent" not in show(PLAIN).inputs


def test_the_choice_of_an_axis_adds_one_node(show, material):
    node = show(BRUSHED)
    assert not tangents(material) and not node.inputs["Tangent"].is_linked
    for axis in ("Z", "X"):
        material.lamina.tangent = axis
        (made,) = tangents(material)
        assert made.direction_type == "RADIAL" and made.axis == axis
        assert node.inputs["Tangent"].links[0].from_node == made
    show(BRUSHED)
    assert len(tangents(material)) == 1
    material.lamina.tangent = "UV"
    assert not tangents(material) and not node.inputs["Tangent"].is_linked


def test_a_choice_before_the_bake_counts(show, material):
    material.lamina.tangent = "Y"
    assert not tangents(material)
    node = show(BRUSHED)
    assert node.inputs["Tangent"].links[0].from_node.axis == "Y"
    show(PLAIN)
    assert not tangents(material)


def test_a_link_of_the_artist_stays(show, material):
    node, tree = show(BRUSHED), material.node_tree
    own = tree.nodes.new("ShaderNodeTangent")
    tree.links.new(own.outputs[0], node.inputs["Tangent"])
    for choice in ("Z", "UV"):
        material.lamina.tangent = choice
        assert node.inputs["Tangent"].links[0].from_node == own and tangents(material) == [own]


def test_removing_the_layers_removes_the_node(addon, lamina, show):
    other = bpy.data.materials.new("Untouched")
    addon.nodes.node_tree.of(other)
    before = serialised_tree.of_material(other)
    addon.editing.layer_list.add_stack(other)
    other.lamina.tangent = "Z"
    addon.editing.stack_io.assign(other, BRUSHED)
    addon.baking.bake_job.apply(other, lamina.bake(addon.editing.stack_io.to_stack(other), "preview", basis="moving"))
    assert tangents(other)
    addon.editing.layer_list.remove_stack(other)
    assert serialised_tree.of_material(other) == before


@pytest.mark.skipif(bpy.app.version >= (5, 0), reason="Blender 5.0 shows anisotropic surfaces")
def test_older_versions_of_blender_say_what_is_needed(addon, lamina, material, call):
    addon.editing.stack_io.assign(material, BRUSHED)
    with pytest.raises(RuntimeError, match=r"anisotropic facets need Blender 5\.0 or newer"):
        call(bpy.ops.lamina.bake, material)
    assert material.lamina.node_group is None


def test_the_panel_shows_both_widths_as_roughness(addon, material):
    base, to_dict = material.lamina.base, addon.editing.stack_io.to_dict
    addon.editing.stack_io.assign(material, {**BRUSHED, "base": {**BRUSHED["base"], "angle": 0.5}})
    base.roughness_v = 0.7
    assert to_dict(material)["base"]["alpha_v"] == pytest.approx(0.49) and base.roughness == pytest.approx(0.1**0.5)
    base.alpha = 0.0  # smooth surfaces have no direction
    assert not {"alpha_v", "angle"} & set(to_dict(material)["base"])
    addon.editing.stack_io.assign(material, BRUSHED)
    assert base.anisotropic and base.angle == 0.0
    addon.editing.stack_io.assign(material, PLAIN)
    assert not base.anisotropic
