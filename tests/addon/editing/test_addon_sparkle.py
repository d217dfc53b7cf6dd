# SPDX-License-Identifier: GPL-3.0-or-later
"""The inputs for sparkle: which materials have them, their first values, and the distance by the camera."""

import bpy
import pytest

from lamina import Interface, Lambert, Medium, Stack, metals

SIZE = 0.0005
FLAKES = metals.flakes("aluminium", 1.0, 0.2)
COATED = Stack([Interface(1.5), FLAKES], Lambert(0.1))
WITHOUT = {
    "no flakes": Stack([Interface(1.5), Medium(0.5, 1.0)], Lambert(0.1)),
    "a rough coat": Stack([Interface(1.5, alpha=0.1), FLAKES], Lambert(0.1)),
}


@pytest.fixture
def bake(addon, material):
    def bake(stack, basis="moving"):
        addon.editing.stack_io.assign_stack(material, stack)
        addon.baking.bake_job.bake_material(material, "preview", basis=basis)
        return material

    return bake


@pytest.fixture
def sparkle(addon):
    return addon.editing.sparkle


@pytest.fixture
def camera():
    data = bpy.data.cameras.new("Camera")
    data.lens, data.sensor_width, data.sensor_fit = 50.0, 36.0, "HORIZONTAL"
    scene = bpy.context.scene
    scene.camera = bpy.data.objects.new("Camera", data)
    scene.collection.objects.link(scene.camera)
    scene.render.resolution_x, scene.render.resolution_y = 1000, 500
    scene.render.resolution_percentage = 50
    return data


def values(sparkle, material):
    return {name: socket.default_value for name, socket in sparkle.sockets(material).items()}


def test_a_bake_starts_without_sparkle(bake, sparkle):
    material = bake(COATED)
    assert values(sparkle, material)["Sparkle"] == 0.0
    assert not sparkle.is_on(material)


@pytest.mark.parametrize("name", WITHOUT)
def test_other_materials_cannot_sparkle(bake, sparkle, addon, name):
    material = bake(WITHOUT[name])
    before = len(material.node_tree.nodes)
    with pytest.raises(addon.base.messages.RefusedError, match=r"Blender 5\.0 or newer, with flakes under smooth"):
        sparkle.add(material, bpy.context.scene)
    assert sparkle.sockets(material) == {}
    assert len(material.node_tree.nodes) == before


def test_the_operator_fades_by_the_camera(bake, sparkle, camera):
    material = bake(COATED)
    mesh = bpy.data.meshes.new("Triangle")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    mesh.materials.append(material)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Triangle", mesh))
    with bpy.context.temp_override(material=material):
        assert bpy.ops.lamina.sparkle() == {"FINISHED"}
    found = values(sparkle, material)
    assert found["Sparkle"] == pytest.approx(0.8)
    assert found["Flake Size"] == pytest.approx(SIZE)
    assert found["Fade Distance"] == pytest.approx(SIZE * 500 * 50.0 / 36.0, rel=1e-5)
    assert "lamina_rest" in mesh.attributes


def test_again_keeps_amount_and_size(bake, sparkle, camera):
    material = bake(COATED)
    sparkle.add(material, bpy.context.scene)
    for name, value in (("Sparkle", 0.3), ("Flake Size", 0.002)):
        sparkle.sockets(material)[name].default_value = value
    camera.lens = 100.0
    distance = sparkle.add(material, bpy.context.scene)
    found = values(sparkle, material)
    assert found["Sparkle"] == pytest.approx(0.3)
    assert distance == found["Fade Distance"] == pytest.approx(0.002 * 500 * 100.0 / 36.0, rel=1e-5)


def test_a_fade_distance_by_hand_stays_without_a_perspective(bake, sparkle, camera, call):
    material = bake(COATED)
    camera.type = "ORTHO"
    assert call(bpy.ops.lamina.sparkle, material) == {"FINISHED"}
    sparkle.sockets(material)["Fade Distance"].default_value = 7.0
    for found in (bpy.context.scene.camera, None):
        bpy.context.scene.camera = found
        with pytest.raises(RuntimeError, match="no perspective camera: set the Fade Distance by hand"):
            call(bpy.ops.lamina.sparkle, material)
    assert values(sparkle, material)["Fade Distance"] == 7.0


def test_sparkle_stays_over_bakes_and_goes_with_the_flakes(bake, sparkle):
    material = bake(COATED)
    sparkle.add(material, bpy.context.scene)
    bake(Stack([Interface(1.5), metals.flakes("copper", 2.0, 0.3)], Lambert(0.2)))
    assert values(sparkle, material)["Sparkle"] == pytest.approx(0.8)
    bake(WITHOUT["no flakes"])
    assert sparkle.sockets(material) == {}
