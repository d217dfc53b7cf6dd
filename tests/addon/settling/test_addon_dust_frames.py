# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust that follows an animation: settled anew at several frames, and played back by Blender's own nodes."""

import bpy
import numpy as np
import own_blender
import pytest
from dusty_objects import NAME, grid, values
from rendered_plane import add_plane, render
from test_addon_dust_job import finish

FIRST, LAST, STEP = 1, 11, 5


@pytest.fixture
def plate(dust):
    """A plate that turns about the Y axis, below a roof that moves."""
    made = grid(cells=6)
    roof = grid("Roof", size=0.6, z=0.5)
    for frame, shift, angle in ((FIRST, -1.0, 0.0), (LAST, 1.0, 0.9)):
        roof.location.x, made.rotation_euler.y = shift, angle
        roof.keyframe_insert("location", index=0, frame=frame)
        made.keyframe_insert("rotation_euler", index=1, frame=frame)
    bpy.context.scene.frame_set(4)
    settings = made.lamina_dust
    settings.over_frames, settings.frames_as = True, "follow"
    settings.frame_first, settings.frame_last, settings.frame_step = FIRST, LAST, STEP
    return made


def shown(obj, frame, subframe=0.0, name=NAME):
    """The values of the evaluated mesh."""
    bpy.context.scene.frame_set(frame, subframe=subframe)
    attribute = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.attributes[name]
    found = np.empty(len(attribute.data), np.float32)
    attribute.data.foreach_get("value", found)
    return found


def alone(dust, obj, frame):
    """The values of a settling at one frame, of a copy of the object."""
    bpy.context.scene.frame_set(frame)
    other = obj.copy()
    other.data = obj.data.copy()
    bpy.context.scene.collection.objects.link(other)
    obj.hide_render, other.lamina_dust.over_frames = True, False
    dust.settle(bpy.context, other)
    found = values(other)
    assert not other.modifiers
    obj.hide_render = False
    bpy.data.objects.remove(other)
    return found


def test_each_frame_shows_its_own_settling_and_between_them_a_blend(dust, plate):
    dust.settle(bpy.context, plate)
    assert bpy.context.scene.frame_current == 4, "the scene stays at its frame"
    single = {frame: alone(dust, plate, frame) for frame in (1, 6, 11)}
    assert np.abs(single[1] - single[6]).max() > 0.3 and np.abs(single[6] - single[11]).max() > 0.3
    for frame, expected in single.items():
        assert shown(plate, frame) == pytest.approx(expected, abs=1e-6)
    assert shown(plate, 3) == pytest.approx(0.6 * single[1] + 0.4 * single[6], abs=1e-6)
    assert shown(plate, 8, 0.5) == pytest.approx(0.5 * single[6] + 0.5 * single[11], abs=1e-6)
    for frame, nearest in ((-20, 1), (200, 11)):
        assert shown(plate, frame) == pytest.approx(single[nearest], abs=1e-6)
    settings = plate.lamina_dust
    assert settings.told.startswith("3 frames; at frame 1 ")
    assert settings.largest == pytest.approx(max(one.max() for one in single.values()))


def test_settling_again_keeps_one_playback_before_other_modifiers(dust, plate):
    bpy.data.objects.remove(bpy.data.objects["Roof"])
    plate.modifiers.new("Thick", "SOLIDIFY").thickness = 0.2
    dust.settle(bpy.context, plate)
    assert [one.name for one in plate.modifiers] == ["Lamina Dust Playback", "Thick"]
    first = shown(plate, 1)
    dust.settle(bpy.context, plate)
    assert [one.name for one in plate.modifiers] == ["Lamina Dust Playback", "Thick"], "settled again: still one"
    assert shown(plate, 1) == pytest.approx(first, abs=1e-6)
    assert len([one for one in bpy.data.node_groups if one.bl_idname == "GeometryNodeTree"]) == 1


def test_both_sides_follow(dust, plate):
    plate.lamina_dust.two_sided = True
    plate.rotation_euler.x = np.pi
    plate.animation_data_clear()
    plate.keyframe_insert("rotation_euler", index=0, frame=1)
    plate.rotation_euler.x = 0.0
    plate.keyframe_insert("rotation_euler", index=0, frame=11)
    dust.settle(bpy.context, plate)
    back = f"{NAME}_back"
    assert shown(plate, 1, name=back).max() > 0.1 and shown(plate, 11, name=back).max() == 0.0
    assert shown(plate, 1).max() == pytest.approx(0.0, abs=1e-6) and shown(plate, 11).max() > 0.5


def test_dust_of_one_frame_and_clearing_end_the_playback(dust, plate):
    dust.settle(bpy.context, plate)
    plate.lamina_dust.over_frames = False
    dust.settle(bpy.context, plate)
    assert not plate.modifiers and [one.name for one in plate.data.attributes if "dust" in one.name] == [NAME]
    plate.lamina_dust.over_frames = True
    dust.settle(bpy.context, plate)
    assert len(plate.modifiers) == 1
    dust.clear(plate)
    assert not plate.modifiers and not [one for one in plate.data.attributes if "dust" in one.name]
    assert not bpy.data.node_groups


def test_a_cancel_leaves_the_dust_as_it_was(dust, plate, addon):
    dust.settle(bpy.context, plate)
    before, told = {frame: shown(plate, frame) for frame in (1, 6, 11)}, plate.lamina_dust.told
    plate.lamina_dust.amount = 3.0
    job = addon.settling.dust_job.start(bpy.context, [plate])
    job.cancel()
    with pytest.raises(addon.base.native.require().Cancelled):
        finish(addon).finish()
    assert all(np.array_equal(shown(plate, frame), values) for frame, values in before.items())
    assert plate.lamina_dust.told == told and len(plate.modifiers) == 1


def test_absurd_requests_are_refused_in_a_sentence(dust, plate, addon, monkeypatch):
    settings, refused = plate.lamina_dust, addon.base.messages.RefusedError
    frames = addon.settling.dust_frames
    for change, sentence in (
        ({"frame_last": 0}, "Last Frame = 0: must be at least First Frame, 1"),
        ({"frame_last": 90_000, "frame_step": 1}, "90000 frames: at most 1000"),
        ({"target": "image"}, "needs an attribute: choose it under Where To"),
    ):
        for name, value in change.items():
            setattr(settings, name, value)
        with pytest.raises(refused, match=sentence):
            dust.settle(bpy.context, plate)
        assert sentence in addon.ui.settled_fields._frames_told(plate)
        settings.target, settings.frame_last, settings.frame_step = "attribute", LAST, STEP
    assert addon.ui.settled_fields._frames_told(plate) == (
        "Settles at 3 frames, 1 to 11; the mesh then holds up to 0.1 MB of dust")
    assert frames.kept_bytes(plate.data, settings) == 4 * 4 * len(plate.data.loops)
    monkeypatch.setattr(frames, "MOST_KEPT", 100)
    with pytest.raises(refused, match="Dust at 3 frames needs 0.1 MB: at most 0.1 MB; raise Frame Step"):
        dust.settle(bpy.context, plate)
    monkeypatch.setattr(frames, "MOST_KEPT", 1 << 30)
    monkeypatch.setattr(frames, "MOST_GATHERED", 1000)
    with pytest.raises(refused, match="meshes of all frames need more than"):
        dust.settle(bpy.context, plate)
    assert not plate.modifiers and settings.told == "" and bpy.context.scene.frame_current == 4


def test_a_mesh_that_changes_its_faces_is_refused(dust, plate, addon):
    build = plate.modifiers.new("Build", "BUILD")
    build.frame_start, build.frame_duration = 1, 20
    with pytest.raises(addon.base.messages.RefusedError, match="(no faces|other vertices, faces or sharp edges)"):
        dust.settle(bpy.context, plate)
    assert len(plate.modifiers) == 1


def test_what_rests_is_held_once(dust, plate, addon):
    grid("Floor", z=-1.0)
    task = dust.gather(bpy.context, plate)
    floors, roofs = ([next(one for one in moment.occluders if one.name == name) for moment in task.moments]
                     for name in ("Floor", "Roof"))
    assert floors[0] is floors[1] is floors[2] and roofs[0] is not roofs[1]


def test_the_render_follows_without_the_add_on(dust, addon, plate, tmp_path, disabled_afterwards):
    material = bpy.data.materials.new("Thickness")
    tree = addon.nodes.node_tree.of(material)
    tree.nodes.clear()
    read, light = tree.nodes.new("ShaderNodeAttribute"), tree.nodes.new("ShaderNodeEmission")
    read.attribute_name = NAME
    tree.links.new(read.outputs["Fac"], light.inputs["Color"])
    tree.links.new(light.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    roof = bpy.data.objects["Roof"]
    dust.settle(bpy.context, plate)
    plate.animation_data_clear()
    plate.rotation_euler.y = 0.0
    roof.hide_render = True
    plate.data.materials.append(material)
    add_plane(material)
    bpy.data.objects["Patch"].hide_render = True
    scene = bpy.context.scene
    scene.camera.location, scene.camera.rotation_euler = (0.0, 0.0, 3.0), (0.0, 0.0, 0.0)
    scene.camera.data.ortho_scale = 2.0
    means = {frame: shown(plate, frame).mean() for frame in (1, 4, 11)}
    assert np.ptp(list(means.values())) > 0.1
    blend = str(tmp_path / "follows.blend")
    bpy.ops.wm.save_as_mainfile(filepath=blend)
    own_blender.disable()
    bpy.ops.wm.open_mainfile(filepath=blend)
    for frame, mean in means.items():
        bpy.context.scene.frame_set(frame)
        assert render(tmp_path / f"{frame}.exr").reshape(-1, 4)[:, 0].mean() == pytest.approx(mean, rel=0.1)
