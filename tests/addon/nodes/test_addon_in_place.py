# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers over a material: the node of the layers in the place of the Principled BSDF, and the way back."""

import bpy
import pytest
import serialised_tree
from addon_helpers import surface_source
from artists_trees import TREES, make

SOCKETS = ("Base Color", "Metallic", "Roughness", "Normal")
INPUTS = ("color", "metallic", "roughness")


@pytest.fixture
def add_over(addon, lamina, tables):
    """add_over(material): layers over the material, with a baked node group; over the values of a Principled BSDF."""

    def add_over(material):
        addon.editing.over_material.add(material, keep_shader=not addon.nodes.principled.find(material))
        kind = material.lamina.base.kind
        if kind not in tables:
            every = lamina.PrincipledBase([0.5, 0.4, 0.3], inputs=INPUTS)
            bases = {"principled": every, "shader": lamina.ShaderBase(0.5)}
            stack = lamina.Stack([lamina.Medium(albedo=0.9, tau=0.5)], bases[kind])
            tables[kind] = lamina.bake(stack, quality="preview")
        addon.baking.bake_job.apply(material, tables[kind])

    return add_over


def with_shader(addon):
    """The materials, by name, whose output a shader feeds."""
    made = {name: make(addon, name) for name in TREES}
    return {name: material for name, material in made.items() if not addon.editing.over_material.problem(material)}


def with_principled(addon):
    """Those whose output a Principled BSDF feeds."""
    return {name: one for name, one in with_shader(addon).items() if addon.nodes.principled.find(one)}


def group_node(material):
    return next(node for node in material.node_tree.nodes
                if node.type == "GROUP" and node.node_tree == material.lamina.node_group)


def fed_by(socket):
    """(node, socket, muted) of the link to an input socket, or None."""
    return next(((link.from_node.name, link.from_socket.identifier, link.is_muted) for link in socket.links), None)


def test_remove_restores_each_tree(addon, add_over):
    for name, material in with_shader(addon).items():
        before = serialised_tree.of_material(material), serialised_tree.of_file()
        add_over(material)
        assert addon.nodes.node_group.is_connected(material)
        addon.editing.layer_list.remove_stack(material)
        assert (serialised_tree.of_material(material), serialised_tree.of_file()) == before, name


def test_remove_after_saving_and_loading(addon, add_over, tmp_path):
    before = {}
    for name, material in with_shader(addon).items():
        before[name] = serialised_tree.of_material(material)
        add_over(material)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "over.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "over.blend"))
    for name, tree in before.items():
        addon.editing.layer_list.remove_stack(bpy.data.materials[name])
        assert serialised_tree.of_material(bpy.data.materials[name]) == tree, name


def test_undo_restores_each_tree(addon, add_over):
    bpy.context.preferences.edit.use_global_undo = True
    before = {name: serialised_tree.of_material(material) for name, material in with_shader(addon).items()}
    bpy.ops.ed.undo_push(message="before")
    for name in before:
        add_over(bpy.data.materials[name])
    bpy.ops.ed.undo_push(message="added")
    added = {name: serialised_tree.of_material(bpy.data.materials[name]) for name in before}
    bpy.ops.ed.undo()
    assert {name: serialised_tree.of_material(bpy.data.materials[name]) for name in before} == before
    bpy.ops.ed.redo()
    assert {name: serialised_tree.of_material(bpy.data.materials[name]) for name in before} == added
    for name in before:
        addon.editing.layer_list.remove_stack(bpy.data.materials[name])
        assert serialised_tree.of_material(bpy.data.materials[name]) == before[name], name


def test_links_and_values_are_carried_and_kept(addon, add_over):
    for name, material in with_principled(addon).items():
        principled = addon.nodes.principled.find(material)
        place, parent = tuple(principled.location), principled.parent
        before = {socket.identifier: fed_by(socket) for socket in principled.inputs}
        add_over(material)
        node = group_node(material)
        assert {socket.identifier: fed_by(socket) for socket in principled.inputs} == before
        assert tuple(node.location) == pytest.approx(place) and node.parent == parent
        assert principled.parent.label == "Before Lamina" and principled.parent.parent == parent
        for socket in SOCKETS:
            if socket in node.inputs:
                given = principled.inputs[socket]
                loose = addon.nodes.links.source(given) is None and before[socket] and not before[socket][2]
                assert fed_by(node.inputs[socket]) == (None if loose else before[socket]), (name, socket)
        colours = [tuple(one.inputs["Base Color"].default_value) for one in (principled, node)]
        assert colours[0] == colours[1]


def test_another_shader_stays_in_use(addon, add_over):
    for name, material in with_shader(addon).items():
        shader = addon.nodes.principled.shown(material)
        if shader.node.type == "BSDF_PRINCIPLED" and not shader.node.mute:
            continue
        ends = fed_by(material.node_tree.get_output_node("CYCLES").inputs["Surface"])
        add_over(material)
        node = group_node(material)
        assert surface_source(material) == node, name
        assert fed_by(node.inputs["Base"]) == ends, name


REFLECTANCES = {
    "glass": (0.1, 0.1, 0.1), "cut out": (0.4, 0.4, 0.4), "glow added": (0.8, 0.8, 0.8), "hair": (0.5, 0.5, 0.5),
    "classic": (0.45, 0.6, 0.5), "own group": (0.5, 0.5, 0.5), "two principled": (0.8, 0.8, 0.8),
}


@pytest.mark.parametrize("name", REFLECTANCES)
def test_the_mean_reflectance_of_another_shader(addon, name):
    material = make(addon, name)
    addon.editing.over_material.add(material)
    base = addon.editing.stack_io.to_dict(material)["base"]
    assert base["kind"] == "shader"
    assert tuple(material.lamina.base.shader_reflectance) == pytest.approx(REFLECTANCES[name], abs=1e-6)


def test_emission_and_alpha(addon, add_over):
    material = make(addon, "glowing leaf")
    principled = addon.nodes.principled.find(material)
    add_over(material)
    mix = surface_source(material)
    assert mix.type == "MIX_SHADER" and fed_by(mix.inputs[0]) == fed_by(principled.inputs["Alpha"])
    assert mix.inputs[1].links[0].from_node.type == "BSDF_TRANSPARENT"
    both = mix.inputs[2].links[0].from_node
    layers, emission = (both.inputs[index].links[0].from_node for index in (0, 1))
    assert layers == group_node(material) and emission.type == "EMISSION"
    assert tuple(emission.inputs["Color"].default_value) == pytest.approx((1.0, 0.6, 0.2, 1.0))
    assert emission.inputs["Strength"].default_value == pytest.approx(3.0)
    view = material.node_tree.nodes.new("ShaderNodeEmission")
    output = material.node_tree.get_output_node("CYCLES")
    material.node_tree.links.new(view.outputs[0], output.inputs["Surface"])
    addon.nodes.node_group.connect(material)
    assert surface_source(material) == mix, "Connect links the end with emission and alpha"


@pytest.mark.parametrize("name", ["metal", "texture", "gltf", "everything"])
def test_no_nodes_behind_the_layers_without_emission_and_alpha(addon, add_over, name):
    material = make(addon, name)
    add_over(material)
    expected = "ADD_SHADER" if name == "gltf" else "GROUP"
    assert surface_source(material).type == expected


def test_layers_over_a_pasted_material(addon, add_over, call):
    """It shows the nodes of another material's layers, which are the artist's now."""
    first, second = make(addon, "metal"), make(addon, "texture")
    add_over(first)
    bpy.ops.mesh.primitive_cube_add()  # the operators need an active object
    call(bpy.ops.material.copy, first)
    call(bpy.ops.material.paste, second)
    before = serialised_tree.of_tree(second.node_tree)
    assert not second.lamina.enabled and surface_source(second).type == "GROUP"
    add_over(second)
    addon.editing.layer_list.remove_stack(second)
    after = serialised_tree.of_tree(second.node_tree)
    assert after["links"] == before["links"] and after["nodes"].keys() == before["nodes"].keys()


@pytest.mark.parametrize("in_strip", [False, True])
def test_animations_are_carried(addon, add_over, in_strip):
    def paths():
        return [curve.data_path for curves in addon.base.f_curves.of_all(animation) for curve in curves]

    material = make(addon, "animated")
    animation = material.node_tree.animation_data
    if in_strip:
        strip = animation.nla_tracks.new().strips.new("Strip", 1, animation.action)
        if hasattr(strip, "action_slot"):
            strip.action_slot = animation.action_slot
        animation.action = None
    before = paths()
    add_over(material)
    node, scene = group_node(material), bpy.context.scene
    principled = addon.nodes.principled.of(addon.nodes.before.source(material.node_tree))
    mesh = bpy.data.meshes.new("Shown")
    mesh.materials.append(material)
    scene.collection.objects.link(bpy.data.objects.new("Shown", mesh))
    seen = set()
    for frame in (1, 7, 15, 33):
        scene.frame_set(frame)
        given = tuple(principled.inputs["Base Color"].default_value)
        assert tuple(node.inputs["Base Color"].default_value) == pytest.approx(given)
        seen.add(given)
    assert len(seen) > 2
    addon.editing.layer_list.remove_stack(material)
    assert paths() == before


def test_nodes_that_the_artist_adds_stay(addon, add_over):
    material = make(addon, "texture")
    tree = material.node_tree
    image = fed_by(addon.nodes.principled.find(material).inputs["Base Color"])
    add_over(material)
    hue = tree.nodes.new("ShaderNodeHueSaturation")
    node = group_node(material)
    tree.links.new(tree.nodes[image[0]].outputs["Color"], hue.inputs["Color"])
    tree.links.new(hue.outputs[0], node.inputs["Base Color"])
    principled = addon.nodes.principled.of(addon.nodes.before.source(tree))
    principled.location = (1000.0, 1000.0)
    hue.parent = principled.parent
    addon.editing.layer_list.remove_stack(material)
    assert hue in list(tree.nodes) and hue.parent is None and not hue.outputs[0].is_linked
    assert fed_by(principled.inputs["Base Color"]) == image
    assert surface_source(material) == principled and principled.location.x < 0.0


def test_a_second_time(addon, add_over):
    material = make(addon, "gltf")
    before = serialised_tree.of_material(material)
    for _ in range(2):
        add_over(material)
        addon.editing.layer_list.remove_stack(material)
        assert serialised_tree.of_material(material) == before


def test_the_base_has_the_values_of_the_material(addon):
    material = make(addon, "painted maps")
    addon.nodes.principled.find(material).inputs["IOR"].default_value = 1.33
    addon.editing.over_material.add(material)
    base = addon.editing.stack_io.to_dict(material)["base"]
    assert base["kind"] == "principled" and base["ior"] == 1.33 and base["roughness"] == 0.5
    assert base["inputs"] == ["color", "metallic", "roughness"]


def test_refused_with_a_sentence(addon, call):
    material = make(addon, "default")
    addon.editing.over_material.add(material)
    with pytest.raises(addon.base.messages.RefusedError, match="has Lamina layers already"):
        addon.editing.over_material.add(material)
    assert not call(bpy.ops.lamina.add_over.poll, material)
