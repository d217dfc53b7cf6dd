# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves in the animation is told, and decides what Exact computes at first."""

import bpy
import pytest


@pytest.fixture
def motion(addon, lamina):
    from bl_ext.user_default.lamina.interior import motion

    return motion


@pytest.fixture
def sun():
    found = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    bpy.context.scene.collection.objects.link(found)
    return found


def moved(obj, path="rotation_euler"):
    obj.keyframe_insert(path, frame=1)
    obj.keyframe_insert(path, frame=20)


def told(motion, obj):
    return motion.sentence(bpy.context, obj, obj.active_material.lamina.interior)


def parent_of(*objects):
    found = bpy.data.objects.new("Turntable", None)
    bpy.context.scene.collection.objects.link(found)
    for one in objects:
        one.parent = found
    return found


def test_lamps_that_move(motion, ball, sun):
    settings = ball.active_material.lamina.interior
    settings.output = "LIT"
    assert told(motion, ball) == ""
    moved(sun.data, "energy")
    moved(sun, "color")
    assert told(motion, ball) == "", "strength and color are inputs"
    moved(sun)
    assert told(motion, ball) == "Sun moves against Ball in the animation: choose Lamps May Move"
    settings.output = "RELIGHTABLE"
    assert told(motion, ball) == ""
    settings.output, sun.hide_render = "LIT", True
    assert told(motion, ball) == ""


def test_lamps_of_an_instanced_collection(motion, ball, sun):
    ball.active_material.lamina.interior.output = "LIT"
    rig = bpy.data.collections.new("Rig")
    rig.objects.link(sun)
    bpy.context.scene.collection.objects.unlink(sun)
    stand = parent_of()
    stand.instance_type, stand.instance_collection = "COLLECTION", rig
    assert told(motion, ball) == ""
    moved(stand)
    assert told(motion, ball) == "Sun moves against Ball in the animation: choose Lamps May Move"
    ball.parent = stand
    assert told(motion, ball) == ""
    sun.hide_render, ball.parent = True, None
    assert told(motion, ball) == ""


def test_a_body_that_moves_with_its_lamp(motion, ball, sun):
    ball.active_material.lamina.interior.output = "LIT"
    table = parent_of(ball)
    moved(table)
    assert "moves against" in told(motion, ball)
    sun.parent = table
    assert told(motion, ball) == ""


def test_a_camera_that_moves(motion, ball):
    settings = ball.active_material.lamina.interior
    settings.output, settings.view = "LIT", "CAMERA"
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    assert told(motion, ball) == ""
    target = parent_of()
    camera.constraints.new("TRACK_TO").target = target
    target.constraints.new("COPY_LOCATION").target = camera  # a cycle, which Blender allows
    assert told(motion, ball) == "", "a constraint that follows what stays"
    moved(target, "location")
    assert told(motion, ball) == "The camera moves in the animation: choose the view All"
    camera.constraints[0].target = ball
    target.animation_data_clear()
    moved(ball, "location")
    assert told(motion, ball) == "The camera moves in the animation: choose the view All", "it turns, and stays"
    settings.view = "ALL"
    assert told(motion, ball) == ""


@pytest.mark.parametrize("how", ["shape key", "driver", "armature", "modifier", "cloth"])
def test_a_body_that_deforms(motion, ball, how):
    if how == "shape key":
        ball.shape_key_add(name="Basis")
        moved(ball.shape_key_add(name="Bent"), "value")
    elif how == "driver":
        ball.shape_key_add(name="Basis")
        ball.shape_key_add(name="Bent").driver_add("value")
    elif how == "armature":
        bones = bpy.data.objects.new("Bones", bpy.data.armatures.new("Bones"))
        ball.modifiers.new("Armature", "ARMATURE").object = bones
        assert told(motion, ball) == "", "a pose that stays"
        moved(bones, "location")
    elif how == "modifier":
        moved(ball.modifiers.new("Displace", "DISPLACE"), "strength")
    else:
        ball.modifiers.new("Cloth", "CLOTH")
    assert told(motion, ball) == "Ball deforms in the animation, but images fit one shape"
    ball.active_material.lamina.interior.source = "LAYERS"
    assert told(motion, ball).endswith(": choose Soft")
