# SPDX-License-Identifier: GPL-3.0-or-later
"""The node group and its image: contents, settings, and the parts that a new bake does not change."""

import bpy
import numpy as np
import pytest
from addon_helpers import image_of, pixels, surface_source


def bake(addon, material):
    lut = addon.baking.bake_job.bake_material(material)
    return material.lamina.node_group, lut


def test_image_settings(addon, lamina, material):
    group, lut = bake(addon, material)
    image = image_of(group)
    assert image.is_float and image.packed_file is not None
    assert image.colorspace_settings.name == "Non-Color"
    assert image.alpha_mode == "CHANNEL_PACKED"
    height = image.size[1]
    assert image.size[0] == 64 and height & (height - 1) == 0
    assert np.array_equal(pixels(image)[: len(lut.image())], lut.image())
    for node in group.nodes:
        if node.type == "TEX_IMAGE":
            assert (node.extension, node.projection) == ("EXTEND", "FLAT")
            assert node.interpolation == ("Closest" if node.label.startswith("Eevee") else "Linear")


def test_pixels_survive_a_save_bit_for_bit(addon, lamina, material, tmp_path):
    material.use_fake_user = True
    group, lut = bake(addon, material)
    name = image_of(group).name
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "kept.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "kept.blend"))
    image = bpy.data.images[name]
    assert np.array_equal(pixels(image)[: len(lut.image())], lut.image())
    assert image.colorspace_settings.name == "Non-Color" and image.alpha_mode == "CHANNEL_PACKED"


def test_group_is_linked_and_other_nodes_stay(addon, lamina, material):
    before = {node.name for node in material.node_tree.nodes}
    group, _ = bake(addon, material)
    assert surface_source(material).node_tree == group
    assert before <= {node.name for node in material.node_tree.nodes}
    assert material.cycles.use_bump_map_correction is False
    assert [item.name for item in group.interface.items_tree] == ["Shader", "Normal"]


def test_every_closure_follows_its_recipe(addon, lamina, material):
    group, lut = bake(addon, material)
    used = [lut.header["closures"][index] for index in addon.nodes.closure_graph.used_closures(lut)]
    recipe_of = addon.nodes.node_group.recipe_source()
    for name in used:
        node = next(node for node in group.nodes if node.label == name)
        recipe = recipe_of(name)
        assert node.bl_idname == recipe.type
        for key, value in recipe.inputs.items():
            found = node.inputs[key].default_value
            assert np.allclose(found, value, rtol=1e-6), (name, key)
        for key, value in recipe.enums.items():
            assert getattr(node, key) == value
        weight = node.inputs[recipe.weight_input].links[0].from_node
        if weight.label == "Cycles only":
            assert weight.inputs[0].default_value == 0.0
            weight = weight.inputs[6].links[0].from_node
        assert weight.type == "TEX_IMAGE" and weight.label.endswith(name)


def test_rebake_keeps_users_links_and_place(addon, lamina, material):
    group, _ = bake(addon, material)
    tree = material.node_tree
    node = surface_source(material)
    node.location = (-777.0, 333.0)
    mix = tree.nodes.new("ShaderNodeMixShader")
    output = tree.get_output_node("CYCLES")
    tree.links.new(node.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])
    bump = tree.nodes.new("ShaderNodeBump")
    tree.links.new(bump.outputs[0], node.inputs["Normal"])
    other = bpy.data.materials.new("Other")
    addon.nodes.node_tree.of(other).nodes.new("ShaderNodeGroup").node_tree = group
    material.lamina.layers[0].tau = 3.0
    again, lut = bake(addon, material)
    assert again == group and material.lamina.node_group == group
    assert tuple(node.location) == (-777.0, 333.0)
    assert surface_source(material) == mix and mix.inputs[2].links[0].from_node == node
    assert node.inputs["Normal"].links[0].from_node == bump
    assert addon.nodes.node_group.is_connected(material)
    assert len(bpy.data.node_groups) == 1 and len(bpy.data.images) == 1
    assert np.array_equal(pixels(image_of(group))[: len(lut.image())], lut.image())


def test_no_orphans_after_many_bakes(addon, lamina, material):
    for tau in (0.5, 1.0, 2.0):
        material.lamina.layers[0].tau = tau
        bake(addon, material)
    assert [image.name for image in bpy.data.images] == ["Lamina Bronze"]
    assert [group.name for group in bpy.data.node_groups] == ["Lamina Bronze"]
    assert bpy.data.images[0].users > 0


def test_thickness_input_comes_and_goes(addon, lamina, material):
    group, _ = bake(addon, material)
    node = surface_source(material)
    assert "Thickness" not in node.inputs
    layer = material.lamina.layers[0]
    layer.varying, layer.tau = True, 2.0
    bake(addon, material)
    assert node.inputs["Thickness"].default_value == pytest.approx(2.0)
    layer.tau = 3.0
    bake(addon, material)
    assert node.inputs["Thickness"].default_value == pytest.approx(3.0), "an untouched input follows"
    node.inputs["Thickness"].default_value = 0.25
    layer.tau = 4.0
    bake(addon, material)
    assert node.inputs["Thickness"].default_value == pytest.approx(0.25), "the user's value stays"
    layer.varying = False
    bake(addon, material)
    assert "Thickness" not in node.inputs and surface_source(material) == node


def test_a_link_to_thickness_stays(addon, lamina, material):
    material.lamina.layers[0].varying = True
    bake(addon, material)
    node = surface_source(material)
    value = material.node_tree.nodes.new("ShaderNodeAttribute")
    material.node_tree.links.new(value.outputs["Fac"], node.inputs["Thickness"])
    material.lamina.layers[0].tau = 5.0
    bake(addon, material)
    assert node.inputs["Thickness"].links[0].from_node == value


def test_a_copied_material_gets_its_own_group(addon, lamina, material):
    group, _ = bake(addon, material)
    copy = material.copy()
    copy.lamina.layers[0].tau = 6.0
    other, _ = bake(addon, copy)
    assert other != group
    assert surface_source(material).node_tree == group
    assert surface_source(copy).node_tree == other
    assert len(copy.node_tree.nodes) == len(material.node_tree.nodes)


@pytest.mark.parametrize("change", ["build", "update"])
def test_an_artists_copy_of_a_group_keeps_its_look(addon, lamina, material, change):
    group, lut = bake(addon, material)
    copy = group.copy()
    kept, before = image_of(copy), pixels(image_of(copy)).copy()
    for _ in range(2):
        assert getattr(addon.nodes.node_group, change)(material, lut)
    assert image_of(copy) == kept and np.array_equal(pixels(kept), before)
    assert image_of(group) != kept and len(bpy.data.images) == 2, "the table between them is gone"


def test_a_failed_build_leaves_everything_as_it_was(addon, lamina, material, monkeypatch):
    group, lut = bake(addon, material)
    nodes = sorted(node.name for node in group.nodes)
    before = pixels(image_of(group)).copy()
    fixed = next(name for name in lut.closures if name in {lobe.id for lobe in lamina.lobes.DICTIONARY})
    lut.header["closures"][lut.closures.index(fixed)] = "nonsense"
    lut.weights[...] = 1.0
    with pytest.raises(addon.nodes.closure_graph.UnknownClosureError, match="nonsense"):
        addon.nodes.node_group.build(material, lut)
    assert sorted(node.name for node in group.nodes) == nodes
    assert len(bpy.data.images) == 1 and np.array_equal(pixels(image_of(group)), before)


def test_sheets_have_two_sides(addon, lamina, material):
    material.lamina.base.kind = "none"
    addon.editing.layer_list.add_layer(material).albedo = (0.2, 0.3, 0.4)
    group, lut = bake(addon, material)
    assert lut.header["sides"] == ["top", "bottom"]
    geometry = next(node for node in group.nodes if node.type == "NEW_GEOMETRY")
    assert geometry.outputs["Backfacing"].is_linked


def test_disconnected_groups_are_noticed_and_connected(addon, lamina, material, call):
    bake(addon, material)
    tree = material.node_tree
    tree.links.new(tree.nodes["Principled BSDF"].outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])
    assert not addon.nodes.node_group.is_connected(material)
    bake(addon, material)
    assert not addon.nodes.node_group.is_connected(material), "a re-bake leaves the user's links alone"
    assert call(bpy.ops.lamina.connect, material) == {"FINISHED"}
    assert addon.nodes.node_group.is_connected(material)
    addon.nodes.node_group.group_nodes(material)[0].mute = True
    assert not addon.nodes.node_group.is_connected(material)
    assert call(bpy.ops.lamina.connect, material) == {"FINISHED"}
    assert addon.nodes.node_group.is_connected(material), "no longer muted"


def test_no_drivers_and_no_scripts(addon, lamina, material):
    group, _ = bake(addon, material)
    assert group.animation_data is None and material.node_tree.animation_data is None
    assert not [node for node in group.nodes if node.type == "SCRIPT"]
