# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's lamps and world as sources of an interior, against Cycles' own light."""

import bpy
import numpy as np
import pytest
from lit_patch import PLACE, SOURCES, irradiance_in_cycles, lit_scene
from mathutils import Euler


@pytest.fixture
def rooms(addon, lamina):
    from bl_ext.user_default.lamina.interior import body, float_render, lights, world_image

    return body, float_render, lights, world_image

def lamps_of(scene, frame):
    from bl_ext.user_default.lamina.base import rendered
    from bl_ext.user_default.lamina.interior import lamps

    body = next((one for one in scene.objects if one.type == "MESH"), None) or bpy.data.objects.new("Body", None)
    return rendered.visit(scene, bpy.context.view_layer, lambda depsgraph: lamps.rendered(depsgraph, frame, body))

def check_irradiance(rooms, lamina, name, ball_scale=(0.01,) * 3, lamp_scale=(1.0,) * 3, **more):
    """A small dense ball that is turned, moved and scaled, in a scene of other units: its light is the irradiance of
    Cycles times that of lamina's sun with irradiance 1."""
    body, float_render, _, _ = rooms
    scene = lit_scene(name, **more)
    scene.objects[name].scale = lamp_scale
    expected = irradiance_in_cycles(float_render, scene)
    assert expected > 0.0
    scene.unit_settings.scale_length = 0.5
    ball = bpy.data.objects.new("Ball", bpy.data.meshes.new("Ball"))
    ball.scale, ball.rotation_euler, ball.location = ball_scale, (0.4, 0.5, 0.6), (0.001, 0.002, 0.0)
    scene.collection.objects.link(ball)
    bpy.context.view_layer.update()
    frame = body.frame_of(ball, scene)
    source = lamps_of(scene, frame)[0]
    corners = 2.0 * (np.array(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij")).reshape(3, -1).T - 0.5)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    cube = lamina.Solid(corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]))
    towards = frame.towards(PLACE.normalized())
    axis = int(np.abs(towards).argmax())
    normal = np.eye(3)[axis] * np.sign(towards[axis])
    found = lamina.light_in_mesh(cube, lamina.Interior.uniform(lamina.EndMaterial(20.0, 20.0)),
                                 [source.lamp(lamina), lamina.Lamp(towards)], [normal], [normal],
                                 samples=60000, seed=3).lamps  # fmt: skip
    ratio = found.value[0, 0] / found.value[0, 1] * source.factor * source.strength
    error = ratio * np.hypot(*(found.stderr[0] / found.value[0]))
    assert (np.abs(ratio - expected) < 3.5 * error + 0.01 * expected).all() and (error < 0.02 * expected).all()


@pytest.mark.parametrize("name", SOURCES)
def test_a_lamp_gives_the_irradiance_of_cycles(rooms, lamina, name):
    check_irradiance(rooms, lamina, name)

MIRRORED = (-1.0, 1.0, 1.0)


@pytest.mark.parametrize(("name", "scales"), [
    ("AREA", {"lamp_scale": MIRRORED}), ("AREA", {"lamp_scale": (1.0, -1.0, 1.0)}),
    *((name, {"ball_scale": (-0.01,) * 3}) for name in SOURCES),
    ("AREA", {"ball_scale": (-0.01, 0.01, 0.01), "lamp_scale": MIRRORED}),
])  # fmt: skip
def test_mirrored_lamps_and_objects(rooms, lamina, name, scales):
    check_irradiance(rooms, lamina, name, **scales)


@pytest.mark.parametrize(("name", "more"), [
    *((name, {}) for name in SOURCES), ("SUN", {"angle": 0.0}), ("POINT", {"shadow_soft_size": 0.0}),
    ("AREA", {"lamp_scale": (2.0, 1.5, 1.0)}),
])  # fmt: skip
def test_lamps_that_are_not_normalized(rooms, lamina, name, more):
    """Their light grows with their size."""
    if "normalize" not in bpy.types.Light.bl_rna.properties:
        pytest.skip("this Blender normalizes all lamps")
    check_irradiance(rooms, lamina, name, normalize=False, **more)


@pytest.mark.parametrize("mirror", [1.0, -1.0])
def test_the_world_in_the_axes_of_an_object(rooms, mirror):
    """A world whose colour is the direction, seen in turned axes and in mirrored ones."""
    _, _, lights, world_image = rooms
    scene = bpy.context.scene
    tree, background = sky()
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["Generated"], background.inputs["Color"])
    background.inputs["Strength"].default_value = 7.0
    axes = np.array(Euler((0.4, 0.5, 0.6)).to_matrix()) * [mirror, 1.0, 1.0]
    before = {kind: len(getattr(bpy.data, kind)) for kind in ("scenes", "worlds", "cameras", "objects")}
    found = world_image.of_scene(scene, axes, background.name)
    assert before == {kind: len(getattr(bpy.data, kind)) for kind in before}
    rows, columns = found.shape[:2]
    height = np.pi * ((np.arange(rows) + 0.5) / rows - 0.5)[:, None]
    azimuth = np.pi * (1.0 - 2.0 * (np.arange(columns) + 0.5) / columns)
    way = np.stack(np.broadcast_arrays(
        np.cos(height) * np.cos(azimuth), np.cos(height) * np.sin(azimuth), np.sin(height)), axis=-1)  # fmt: skip
    np.testing.assert_allclose(found, np.maximum(way @ axes.T, 0.0), atol=0.02)
    assert lights.world(scene, frame_with(axes)).strength == 7.0


def frame_with(axes):
    from bl_ext.user_default.lamina.interior import body

    return body.Frame(np.array(axes), np.zeros(3), 1.0, 1000.0)


def sky():
    """(tree, its Background) of a new world of the scene, whose Background has the colour (.1, .2, .3)."""
    from bl_ext.user_default.lamina.nodes import node_tree

    world = bpy.context.scene.world = bpy.data.worlds.new("Sky")
    tree = node_tree.of(world)
    background = next(node for node in tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.1, 0.2, 0.3, 1.0)
    background.inputs["Strength"].default_value = 1.0
    return tree, background


def shown(tree, shader):
    """Link a shader node to the world's output."""
    output = next(node for node in tree.nodes if node.type == "OUTPUT_WORLD")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])


def mixed(tree, background):
    """The Background of strength 2, mixed half and half with a red one: (.6, .2, .3)."""
    background.inputs["Strength"].default_value = 2.0
    other, mix = tree.nodes.new("ShaderNodeBackground"), tree.nodes.new("ShaderNodeMixShader")
    other.inputs["Color"].default_value, other.inputs["Strength"].default_value = (0.5, 0.0, 0.0, 1.0), 2.0
    mix.inputs[0].default_value = 0.5
    for number, node in enumerate((background, other)):
        tree.links.new(node.outputs[0], mix.inputs[1 + number])
    shown(tree, mix)


def emission(tree, _background):
    node = tree.nodes.new("ShaderNodeEmission")
    node.inputs["Color"].default_value, node.inputs["Strength"].default_value = (0.1, 0.2, 0.3, 1.0), 2.0
    shown(tree, node)


def linked_strength(tree, background):
    value = tree.nodes.new("ShaderNodeValue")
    value.outputs[0].default_value = 3.0
    tree.links.new(value.outputs[0], background.inputs["Strength"])


def grouped(tree, background):
    inside = bpy.data.node_groups.new("Inside", "ShaderNodeTree")
    inside.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    node = inside.nodes.new("ShaderNodeBackground")
    node.inputs["Color"].default_value, node.inputs["Strength"].default_value = (0.1, 0.2, 0.3, 1.0), 4.0
    inside.links.new(node.outputs[0], inside.nodes.new("NodeGroupOutput").inputs[0])
    outside = tree.nodes.new("ShaderNodeGroup")
    outside.node_tree = inside
    shown(tree, outside)


def behind_the_camera(tree, background):
    """Ray Visibility for the camera does not change what lights the object."""
    bpy.context.scene.world.cycles_visibility.camera = False
    linked_strength(tree, background)


@pytest.mark.parametrize(("change", "colour"), [
    (mixed, (0.6, 0.2, 0.3)), (emission, (0.2, 0.4, 0.6)), (linked_strength, (0.3, 0.6, 0.9)),
    (grouped, (0.4, 0.8, 1.2)), (behind_the_camera, (0.3, 0.6, 0.9)),
])  # fmt: skip
def test_a_world_of_other_nodes_is_an_image(rooms, change, colour):
    _, _, lights, _ = rooms
    change(*sky())
    found = lights.world(bpy.context.scene, frame_with(np.eye(3)))
    assert (found.strength, found.colour) == (1.0, (1.0, 1.0, 1.0))
    np.testing.assert_allclose(found.radiance, np.broadcast_to(colour, found.radiance.shape), rtol=1e-4)


def unlinked(tree, _background):
    tree.links.clear()


def unseen(_tree, _background):
    bpy.context.scene.world.cycles_visibility.diffuse = False


def no_world(_tree, _background):
    bpy.context.scene.world = None


@pytest.mark.parametrize("change", [unlinked, unseen, no_world])
def test_a_dark_world(rooms, change):
    _, _, lights, _ = rooms
    change(*sky())
    found = lights.world(bpy.context.scene, frame_with(np.eye(3)))
    assert found.strength == 0.0 and found.is_dark and found.radiance is None


def test_the_linked_background_counts(rooms):
    """Not one that lies about in the tree; through a reroute."""
    _, _, lights, _ = rooms
    tree, background = sky()
    second, reroute = tree.nodes.new("ShaderNodeBackground"), tree.nodes.new("NodeReroute")
    second.inputs["Color"].default_value, second.inputs["Strength"].default_value = (0.5, 0.0, 0.0, 1.0), 3.0
    tree.links.new(second.outputs[0], reroute.inputs[0])
    shown(tree, reroute)
    found = lights.world(bpy.context.scene, frame_with(np.eye(3)))
    assert (found.strength, found.colour, found.radiance) == (3.0, (0.5, 0.0, 0.0), None)


def test_a_world_without_nodes(rooms):
    from bl_ext.user_default.lamina.nodes import node_tree

    _, _, lights, _ = rooms
    sky()
    world = bpy.context.scene.world
    if bpy.app.version >= (5, 0, 0):
        pytest.skip("from Blender 5.0 on, every world has nodes")
    node_tree.switch_off(world)
    world.color = (0.2, 0.3, 0.4)
    found = lights.world(bpy.context.scene, frame_with(np.eye(3)))
    assert (found.strength, found.colour) == (1.0, pytest.approx((0.2, 0.3, 0.4)))


def test_light_paths_in_groups_are_refused(rooms):
    _, _, lights, _ = rooms
    grouped(*sky())
    bpy.data.node_groups["Inside"].nodes.new("ShaderNodeLightPath")
    with pytest.raises(ValueError, match="Sky has a Light Path node"):
        lights.world(bpy.context.scene, frame_with(np.eye(3)))


def test_lamps_that_light_no_diffuse_surface(rooms):
    """Neither portals of the world's light nor lamps without Ray Visibility for diffuse rays; and instances count."""
    scene = lit_scene("POINT")
    portal = bpy.data.objects.new("Portal", bpy.data.lights.new("Portal", "AREA"))
    portal.data.cycles.is_portal = True
    glint = bpy.data.objects.new("Glint", bpy.data.lights.new("Glint", "POINT"))
    glint.visible_diffuse = False
    pair = bpy.data.collections.new("Pair")
    pair.objects.link(bpy.data.objects.new("POINT of Pair", bpy.data.lights.new("P", "POINT")))
    for obj in (portal, glint, *(bpy.data.objects.new(f"Instance {n}", None) for n in range(2))):
        scene.collection.objects.link(obj)
        if obj.type == "EMPTY":
            obj.instance_type, obj.instance_collection = "COLLECTION", pair
            obj.location.x = 1.0 if obj.name.endswith("1") else 2.0
    found = lamps_of(scene, frame_with(np.eye(3)))
    assert [one.name for one in found] == ["POINT", "POINT of Pair", "POINT of Pair 2"]
    assert sorted(one.numbers["position"][0] for one in found[1:]) == [1000.0, 2000.0]


def test_names_of_sources(rooms):
    """Unique, other than the world's, and short enough for sockets."""
    from bl_ext.user_default.lamina.interior import lamps

    long = "é" * 40
    names = lamps.unique(["Key", "Key", "World", long, long])
    assert names[:3] == ["Key", "Key 2", "World 2"] and len(set(names)) == 5
    assert all(len(f"{name} Strength".encode()) <= 63 for name in names)
    group = bpy.data.node_groups.new("Group", "ShaderNodeTree")
    for name in names:
        socket = group.interface.new_socket(f"{name} Strength", in_out="INPUT", socket_type="NodeSocketFloat")
        assert socket.name == f"{name} Strength"
