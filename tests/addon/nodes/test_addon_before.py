# SPDX-License-Identifier: GPL-3.0-or-later
"""Removing Lamina restores the tree: each node, value, link, place, frame and animation."""

import bpy
import pytest
import serialised_tree
from addon_helpers import surface_source
from artists_trees import TREES, make


@pytest.fixture
def add(addon, lamina, tables):
    """add(material): layers with their baked node group, as the panel's plain Add and Bake make."""

    def add(material):
        addon.editing.layer_list.add_stack(material)
        material.lamina.base.kind = "lambert"
        if "lambert" not in tables:
            tables["lambert"] = lamina.bake(addon.editing.stack_io.to_stack(material), quality="preview")
        addon.baking.bake_job.apply(material, tables["lambert"])

    return add


def everything(material):
    return serialised_tree.of_material(material), serialised_tree.of_file()


@pytest.mark.parametrize("name", TREES)
def test_add_and_remove(addon, add, name):
    material = make(addon, name)
    before = everything(material)
    add(material)
    assert addon.nodes.node_group.is_connected(material)
    addon.editing.layer_list.remove_stack(material)
    assert everything(material) == before


def test_after_a_bake_again_and_after_saving(addon, add, tmp_path):
    before = {}
    for name in TREES:
        before[name] = serialised_tree.of_material(make(addon, name))
    for name in TREES:
        add(bpy.data.materials[name])
        add(bpy.data.materials[name])
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "trees.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "trees.blend"))
    for name in TREES:
        addon.editing.layer_list.remove_stack(bpy.data.materials[name])
        assert serialised_tree.of_material(bpy.data.materials[name]) == before[name], name


def test_undo_of_add_and_of_remove(addon, add):
    bpy.context.preferences.edit.use_global_undo = True
    for name in TREES:
        make(addon, name)
    bpy.ops.ed.undo_push(message="before")
    before = {name: everything(bpy.data.materials[name]) for name in TREES}
    for name in TREES:
        add(bpy.data.materials[name])
    bpy.ops.ed.undo_push(message="added")
    added = {name: everything(bpy.data.materials[name]) for name in TREES}
    for name in TREES:
        addon.editing.layer_list.remove_stack(bpy.data.materials[name])
    bpy.ops.ed.undo_push(message="removed")
    bpy.ops.ed.undo()
    assert {name: everything(bpy.data.materials[name]) for name in TREES} == added
    bpy.ops.ed.undo()
    assert {name: everything(bpy.data.materials[name]) for name in TREES} == before
    bpy.ops.ed.redo()
    for name in TREES:
        addon.editing.layer_list.remove_stack(bpy.data.materials[name])
    assert {name: everything(bpy.data.materials[name]) for name in TREES} == before


def test_nodes_that_the_artist_puts_behind_the_layers_stay(addon, add):
    material = make(addon, "texture")
    tree = material.node_tree
    add(material)
    group = surface_source(material)
    mix, paint = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeBsdfDiffuse")
    output = tree.get_output_node("CYCLES")
    tree.links.new(group.outputs["Shader"], mix.inputs[1])
    tree.links.new(paint.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])
    addon.nodes.node_group.connect(material)
    tree.links.new(mix.outputs[0], output.inputs["Surface"])
    copy = tree.nodes.new("NodeReroute")  # the artist's copy of a node of Lamina's
    copy["lamina_made"] = "Reroute"
    addon.editing.layer_list.remove_stack(material)
    assert surface_source(material) == mix
    assert mix.inputs[1].links[0].from_node.type == "BSDF_PRINCIPLED"
    assert mix.inputs[2].links[0].from_node == paint
    assert copy in list(tree.nodes) and not copy.keys()


def test_a_shader_that_the_artist_links_instead_stays(addon, add):
    material = make(addon, "texture")
    tree = material.node_tree
    add(material)
    view = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(view.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])
    addon.nodes.node_group.connect(material)
    assert surface_source(material).type == "GROUP"
    addon.editing.layer_list.remove_stack(material)
    assert surface_source(material) == view, "the shader of the time of Connect"


def test_a_renamed_source_and_an_unlinked_output(addon, add):
    material = make(addon, "texture")
    tree = material.node_tree
    add(material)
    principled = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    principled.name = "Renamed"
    tree.links.remove(tree.get_output_node("CYCLES").inputs["Surface"].links[0])
    addon.editing.layer_list.remove_stack(material)
    assert surface_source(material).name == "Renamed"


def test_thickness_and_lateral_nodes_go_too(addon, lamina, add):
    material = make(addon, "volume")
    before = everything(material)
    add(material)
    stack = lamina.Stack([lamina.Medium(sigma_s=2.0, sigma_a=0.001, thickness=float("inf"))])
    addon.editing.stack_io.assign_stack(material, stack)
    material.lamina.lateral = "PORTAL"
    addon.baking.lateral_job.make(material)
    layers = [lamina.Medium(albedo=0.9, tau=1.0, varying=True)]
    addon.editing.stack_io.assign_stack(material, lamina.Stack(layers, base=lamina.Lambert(0.5)))
    addon.baking.bake_job.bake_material(material, "preview")
    addon.nodes.thickness.wire_thickness(material, "attribute")
    addon.editing.layer_list.remove_stack(material)
    assert everything(material) == before


def put_into_own_group(material):
    """Put the layers' node into a group of the artist's, as Make Group does. Returns the node of this group."""
    tree, node = material.node_tree, surface_source(material)
    group = bpy.data.node_groups.new("Mine", "ShaderNodeTree")
    group.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    group.interface.new_socket("Color", in_out="INPUT", socket_type="NodeSocketColor")
    group.interface.new_socket("Share", in_out="OUTPUT", socket_type="NodeSocketFloat")
    inside, given, end = (group.nodes.new(kind) for kind in ("ShaderNodeGroup", "NodeGroupInput", "NodeGroupOutput"))
    inside.node_tree = node.node_tree
    group.links.new(given.outputs[0], inside.inputs["Base Color"])
    group.links.new(inside.outputs["Shader"], end.inputs[0])
    around = tree.nodes.new("ShaderNodeGroup")
    around.node_tree = group
    tree.links.new(node.inputs["Base Color"].links[0].from_socket, around.inputs[0])
    tree.links.new(around.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])
    tree.nodes.remove(node)
    return around


def test_the_artists_group_around_the_layers_stays(addon, lamina, call):
    material = make(addon, "texture")
    tree, shader = material.node_tree, surface_source(material)
    material.lamina.quality = "preview"
    addon.editing.over_material.add(material)
    addon.baking.bake_job.bake_material(material, "preview")
    around, bent = put_into_own_group(material), tree.nodes.new("ShaderNodeMath")
    tree.links.new(around.outputs["Share"], bent.inputs[0])
    assert addon.nodes.node_group.is_connected(material)
    group = material.lamina.node_group
    addon.editing.layer_list.add_layer(material, "interface")
    addon.baking.bake_job.bake_material(material, "preview")
    assert surface_source(material) == around and material.lamina.node_group == group
    assert not addon.nodes.node_group.group_nodes(material)
    assert addon.baking.bake_job.state(material) in ("fresh", "other")
    assert call(bpy.ops.lamina.connect, material) == {"FINISHED"}
    assert surface_source(material).node_tree == group, "the artist wants a node of the layers here"
    addon.editing.layer_list.remove_stack(material)
    assert surface_source(material) == shader and tree.nodes[around.name] and bent.inputs[0].is_linked


def test_remove_restores_what_was_below_the_artists_group(addon, lamina):
    material = make(addon, "texture")
    shader = surface_source(material)
    addon.editing.over_material.add(material)
    addon.baking.bake_job.bake_material(material, "preview")
    around = put_into_own_group(material)
    addon.editing.layer_list.remove_stack(material)
    assert surface_source(material) == shader and not around.outputs["Shader"].is_linked


def test_sources_refuse_layers_inside_the_artists_group(addon, lamina, call):
    material = make(addon, "texture")
    bpy.ops.mesh.primitive_plane_add()
    plane = bpy.context.object
    plane.data.materials.append(material)
    addon.editing.over_material.add(material)
    addon.baking.bake_job.bake_material(material, "preview")
    put_into_own_group(material)
    for name in ("SETTLED", "PAINTED", "IMAGE"):
        with pytest.raises(RuntimeError, match="The layers' node is inside your group “Mine”: ungroup it first"):
            call(bpy.ops.lamina.place, material, place=name)
    done = addon.scene.dusting.dust(bpy.context, [plane])
    assert "inside your group “Mine”" in str(done) and not done.bakes
    assert not material.lamina.layers[0].varying and len(material.lamina.layers) == 1
