# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of the lateral group over rebuilds: what the artist has linked, set and animated there."""

import bpy
import pytest

MILLIMETRE = 0.001


@pytest.fixture
def group_of(addon):
    """group_of(material, {name: value}, again=False): build the material's lateral group with these inputs of lamps."""
    from bl_ext.user_default.lamina.nodes import lateral_group

    def draw(graph, _length, sockets):
        shader = graph.node("ShaderNodeEmission", "shader")
        for socket in sockets:
            if socket.name.startswith("Key"):
                graph.link(socket, shader.inputs["Strength"])
        return shader.outputs[0], None

    def build(material, lamps, again=False, draw=draw):
        inputs = [(f"{name} Strength", "NodeSocketFloat", value, "") for name, value in lamps.items()]
        return lateral_group.build(material, "Lit", draw, MILLIMETRE, inputs, again)

    return build


@pytest.fixture
def stone(addon):
    return bpy.data.materials.new("Stone")


def node_of(material):
    (found,) = (node for node in material.node_tree.nodes if node.type == "GROUP")
    return found


def values(material):
    return {socket.name: socket.default_value for socket in node_of(material).inputs if socket.name != "Millimetre"}


def curves(tree):
    from bl_ext.user_default.lamina.base import f_curves

    return {curve.data_path: curve.evaluate(1) for curve in f_curves.of_active(tree.animation_data)}


def test_links_and_values_stay(group_of, stone):
    """Of the artist; a value that was not changed follows the scene's lamp."""
    group_of(stone, {"Key": 2.0, "Fill": 1.0, "World": 0.5})
    node, tree = node_of(stone), stone.node_tree
    number = tree.nodes.new("ShaderNodeValue")
    tree.links.new(number.outputs[0], node.inputs["Key Strength"])
    node.inputs["World Strength"].default_value = 0.9
    group_of(stone, {"Area": 7.0, "Key": 3.0, "Fill": 4.0, "World": 0.6})
    assert node_of(stone).inputs["Key Strength"].links[0].from_node == number
    assert values(stone) == pytest.approx(
        {"Key Strength": 2.0, "Fill Strength": 4.0, "World Strength": 0.9, "Area Strength": 7.0}
    )
    # A socket that comes back is a new one.
    group_of(stone, {"Fill": 4.0})
    group_of(stone, {"Fill": 4.0, "Key": 5.0})
    assert not node_of(stone).inputs["Key Strength"].is_linked
    assert values(stone) == pytest.approx({"Fill Strength": 4.0, "Key Strength": 5.0})


def test_animation_stays_with_its_socket(addon, group_of, stone):
    """F-curves and drivers, in every material with the group; those of a lamp that has gone go."""
    group = group_of(stone, {"Key": 2.0, "Fill": 1.0, "World": 0.5})
    other = bpy.data.materials.new("Other")
    second = addon.nodes.node_tree.of(other).nodes.new("ShaderNodeGroup")
    second.node_tree = group
    node = node_of(stone)
    for name, value in (("Key Strength", 5.0), ("World Strength", 0.9)):
        node.inputs[name].default_value = value
        node.inputs[name].keyframe_insert("default_value", frame=1)
    second.inputs["World Strength"].default_value = 0.7
    second.inputs["World Strength"].keyframe_insert("default_value", frame=1)
    for name, value in (("Key Strength", "11.0"), ("Fill Strength", "12.0")):
        second.inputs[name].driver_add("default_value").driver.expression = value
    group_of(stone, {"Area": 7.0, "Fill": 1.0, "World": 0.5})
    node = node_of(stone)
    assert [socket.name for socket in node.inputs][1:] == ["Fill Strength", "World Strength", "Area Strength"]
    assert curves(stone.node_tree) == {node.inputs["World Strength"].path_from_id("default_value"): pytest.approx(0.9)}
    assert curves(other.node_tree) == {
        second.inputs["World Strength"].path_from_id("default_value"): pytest.approx(0.7)
    }
    drivers = {one.data_path: one.driver.expression for one in other.node_tree.animation_data.drivers}
    assert drivers == {second.inputs["Fill Strength"].path_from_id("default_value"): "12.0"}


def test_animation_in_strips(group_of, stone):
    group_of(stone, {"Key": 2.0, "World": 0.5})
    socket = node_of(stone).inputs["World Strength"]
    socket.keyframe_insert("default_value", frame=1)
    animation = stone.node_tree.animation_data
    action = animation.action
    strip = animation.nla_tracks.new().strips.new("Strip", 1, action)
    if hasattr(strip, "action_slot"):
        strip.action_slot = animation.action_slot
    animation.action = None
    group_of(stone, {"World": 0.5})
    from bl_ext.user_default.lamina.base import f_curves

    paths = [curve.data_path for curve in f_curves.of_active(strip)]
    assert paths == [node_of(stone).inputs["World Strength"].path_from_id("default_value")]


def test_again_keeps_all_values(group_of, stone):
    group_of(stone, {"Key": 2.0})
    group_of(stone, {"Key": 3.0}, again=True)
    assert values(stone) == pytest.approx({"Key Strength": 2.0})


def test_a_failure_leaves_the_inputs(group_of, stone):
    def fail(_graph, _length, _sockets):
        raise KeyError("of the drawing")

    group_of(stone, {"Key": 2.0})
    with pytest.raises(KeyError):
        group_of(stone, {"Fill": 1.0}, draw=fail)
    assert values(stone) == pytest.approx({"Key Strength": 2.0})


def test_a_copied_material_keeps_its_links(group_of, stone):
    """It gets a group of its own, in the same node; the original's group is unchanged."""
    first = group_of(stone, {"Key": 2.0})
    number = stone.node_tree.nodes.new("ShaderNodeValue")
    stone.node_tree.links.new(number.outputs[0], node_of(stone).inputs["Key Strength"])
    copy = stone.copy()
    second = group_of(copy, {"Key": 3.0, "Fill": 1.0})
    assert node_of(copy).node_tree == second != first == node_of(stone).node_tree
    assert node_of(copy).inputs["Key Strength"].is_linked and node_of(stone).inputs["Key Strength"].is_linked
    assert list(values(stone)) == ["Key Strength"] and list(values(copy)) == ["Key Strength", "Fill Strength"]
