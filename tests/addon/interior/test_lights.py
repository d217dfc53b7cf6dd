# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's lamps and world as sources of an interior, against Cycles' own light."""

import bpy
import numpy as np
import pytest
from mathutils import Euler, Vector

SOURCES = {
    "SUN": {"energy": 2.0, "angle": 0.1},
    "POINT": {"energy": 900.0, "shadow_soft_size": 0.3},
    "SPOT": {"energy": 1500.0, "shadow_soft_size": 0.1, "spot_size": 0.5, "spot_blend": 0.4},
    "AREA": {"energy": 700.0, "shape": "RECTANGLE", "size": 0.8, "size_y": 0.4},
    "DISK": {"energy": 700.0, "shape": "DISK", "size": 0.8},
}
PLACE = Vector((3.0, -4.0, 9.0))


@pytest.fixture
def rooms(addon, lamina):
    from bl_ext.user_default.lamina.interior import body, float_render, lights, world_image

    return body, float_render, lights, world_image


def lit_scene(name):
    """The scene with one lamp that shines at the origin; a spot shines a little beside the origin."""
    scene, numbers = bpy.context.scene, dict(SOURCES[name])
    kind = "AREA" if name == "DISK" else name
    obj = bpy.data.objects.new(name, bpy.data.lights.new(name, kind))
    for field, value in numbers.items():
        setattr(obj.data, field, value)
    turn = (PLACE - Vector((0.0, 0.0, 2.0 if name == "SPOT" else 0.0))).to_track_quat("Z", "Y")
    obj.location, obj.rotation_euler = PLACE, turn.to_euler()
    scene.collection.objects.link(obj)
    scene.world = bpy.data.worlds.new("Dark")
    scene.world.color = (0.0, 0.0, 0.0)
    # From Blender 5.0 on, a new world has nodes, with a grey background.
    for node in scene.world.node_tree.nodes if scene.world.node_tree is not None else ():
        if node.type == "BACKGROUND":
            node.inputs["Strength"].default_value = 0.0
    bpy.context.view_layer.update()
    return scene


def irradiance_in_cycles(float_render, scene):
    """At the origin, on a plane perpendicular to the light: pi times the radiance of a white diffuse patch."""
    from bl_ext.user_default.lamina.nodes import node_tree

    mesh = bpy.data.meshes.new("Patch")
    mesh.from_pydata([(-0.01, -0.01, 0), (0.01, -0.01, 0), (0.01, 0.01, 0), (-0.01, 0.01, 0)], [], [(0, 1, 2, 3)])
    patch = bpy.data.objects.new("Patch", mesh)
    material = bpy.data.materials.new("White")
    node_tree.of(material).nodes.clear()
    shader = material.node_tree.nodes.new("ShaderNodeBsdfDiffuse")
    shader.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    output = material.node_tree.nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(shader.outputs[0], output.inputs["Surface"])
    mesh.materials.append(material)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 0.01
    turn = PLACE.to_track_quat("Z", "Y")
    patch.rotation_euler = camera.rotation_euler = turn.to_euler()
    camera.location = 0.5 * PLACE.normalized() + turn @ Vector((0.001, 0.002, 0.0))
    for obj in (patch, camera):
        scene.collection.objects.link(obj)
    scene.camera = camera
    float_render.prepare(scene, 4, 4)
    scene.cycles.samples = 1024
    return np.pi * float_render.picture(scene)[..., 0].mean()


@pytest.mark.parametrize("name", SOURCES)
def test_a_lamp_gives_the_irradiance_of_cycles(rooms, lamina, name):
    """A small dense ball that is turned, moved and scaled, in a scene of other units: its light is the irradiance of
    Cycles times that of lamina's sun with irradiance 1."""
    body, float_render, lights, _ = rooms
    scene = lit_scene(name)
    expected = irradiance_in_cycles(float_render, scene)
    scene.unit_settings.scale_length = 0.5
    ball = bpy.data.objects.new("Ball", bpy.data.meshes.new("Ball"))
    ball.scale, ball.rotation_euler, ball.location = (0.01,) * 3, (0.4, 0.5, 0.6), (0.001, 0.002, 0.0)
    scene.collection.objects.link(ball)
    bpy.context.view_layer.update()
    frame = body.frame_of(ball, scene)
    source = lights.lamps(scene, frame)[0]
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


def test_the_world_in_the_axes_of_an_object(rooms):
    """A world whose colour is the direction, seen in turned axes."""
    from bl_ext.user_default.lamina.nodes import node_tree

    _, _, lights, world_image = rooms
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("Directions")
    tree = node_tree.of(scene.world)
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    background = next(node for node in tree.nodes if node.type == "BACKGROUND")
    tree.links.new(coordinates.outputs["Generated"], background.inputs["Color"])
    background.inputs["Strength"].default_value = 7.0
    axes = np.array(Euler((0.4, 0.5, 0.6)).to_matrix())
    before = {kind: len(getattr(bpy.data, kind)) for kind in ("scenes", "worlds", "cameras", "objects")}
    found = world_image.of_scene(scene, axes)
    assert before == {kind: len(getattr(bpy.data, kind)) for kind in before}
    rows, columns = found.shape[:2]
    height = np.pi * ((np.arange(rows) + 0.5) / rows - 0.5)[:, None]
    azimuth = np.pi * (1.0 - 2.0 * (np.arange(columns) + 0.5) / columns)
    way = np.stack(np.broadcast_arrays(
        np.cos(height) * np.cos(azimuth), np.cos(height) * np.sin(azimuth), np.sin(height)), axis=-1)  # fmt: skip
    np.testing.assert_allclose(found, np.maximum(way @ axes.T, 0.0), atol=0.02)
    assert lights.world(scene, type("", (), {"axes": axes})).strength == 7.0


def test_what_moved(rooms):
    body, _, lights, _ = rooms
    scene = lit_scene("AREA")
    ball = bpy.data.objects.new("Ball", bpy.data.meshes.new("Ball"))
    frame = body.frame_of(ball, scene)
    kept = lights.kept(lights.lamps(scene, frame))
    lamp = scene.objects["AREA"]
    lamp.data.energy = 5.0
    assert lights.moved(kept, scene, frame) == []
    lamp.data.size = 0.9
    assert lights.moved(kept, scene, frame) == ["AREA"]
    lamp.data.size, lamp.location.x = 0.8, 4.0
    bpy.context.view_layer.update()
    assert lights.moved(kept, scene, frame) == ["AREA"]
