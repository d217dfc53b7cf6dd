# SPDX-License-Identifier: GPL-3.0-or-later
"""`--command lamina interior ...`: images, settings, parts after an interruption, and exit codes."""

import signal
from functools import partial

import bpy
import pytest
from addon_helpers import icosphere, pixels


@pytest.fixture
def run(run):
    """run(*arguments) -> (exit code, lines of stdout, stderr) of `interior`"""
    return partial(run, "interior")


@pytest.fixture
def ball(addon):
    mesh = icosphere("Ball", 0.01)
    obj = bpy.data.objects.new("Ball", mesh)
    bpy.context.scene.collection.objects.link(obj)
    material = bpy.data.materials.new("Marble")
    addon.nodes.node_tree.of(material)
    mesh.materials.append(material)
    settings = material.lamina.interior
    settings.resolution, settings.size, settings.noise = 16, 64, 40.0
    bpy.context.view_layer.update()
    return obj


def test_both_kinds_and_a_saved_file(run, ball, tmp_path):
    target = tmp_path / "out.blend"
    code, lines, _ = run("Ball", "--size", 12, "--output", target)
    assert code == 0 and len(lines) == 1 and lines[0].startswith("Ball: Colors and radii: ") and target.is_file()
    settings = ball.active_material.lamina.interior
    assert settings.size == 12
    bpy.context.scene.world = bpy.data.worlds.new("Sky")
    code, lines, err = run("B*", "--kind", "lit", "--noise", 50)
    assert code == 0 and lines[0].startswith("Ball: Light: ") and "nothing was saved" in err
    group = ball.active_material.lamina.lateral_group
    assert [node.label for node in group.nodes if node.type == "TEX_IMAGE"] == [
        "World", "World by view", "World by view squared"]


def test_layers_of_a_newer_lamina_are_left_alone(run, addon, ball):
    settings = ball.active_material.lamina
    settings.schema = addon.properties.material_properties.SCHEMA + 1
    code, lines, _ = run("Ball", "--size", 12)
    assert code == 1 and lines == ["Ball: failed: Marble is from a newer version of Lamina"]
    assert settings.lateral_group is None and settings.interior.size == 64


@pytest.mark.parametrize(("arguments", "code", "words"), [
    (("Cube",), 2, "no mesh object of the scene matches 'Cube'"),
    (("Ball", "--kind", "both"), 2, "invalid choice"),
    ((), 2, "required"),
    (("Ball", "--size", "1"), 2, "argument --size: '1': must be a whole number from 4 to 8192"),
    (("Ball", "--size", "100000"), 2, "must be a whole number from 4 to 8192"),
    (("Ball", "--noise", "0"), 2, "argument --noise: '0': must be a number from 0.01 to 100"),
    (("Ball", "--noise", "nan"), 2, "must be a number from 0.01 to 100"),
    (("Ball", "--noise=-1"), 2, "must be a number from 0.01 to 100"),
    (("Ball", "--noise", "abc"), 2, "must be a number from 0.01 to 100"),
    (("Ball", "--threads", "-1"), 2, "--threads"),
])  # fmt: skip
def test_bad_arguments_are_one_sentence(run, ball, arguments, code, words):
    """And neither the settings nor the nodes change."""
    found, lines, err = run(*arguments)
    assert found == code and words in err and not lines
    settings = ball.active_material.lamina.interior
    assert (settings.size, settings.output) == (64, "RELIGHTABLE") and ball.active_material.lamina.lateral_group is None


def test_the_limits_are_those_of_the_panel(ball):
    from bl_ext.user_default.lamina.command_line import arguments

    properties = ball.active_material.lamina.interior.bl_rna.properties
    for name in ("size", "noise"):
        for limit in (properties[name].hard_min, properties[name].hard_max):
            text = f"{limit:g}"
            found = getattr(arguments.parse(["interior", "Ball", f"--{name}", text]), name)
            assert found == pytest.approx(limit, rel=1e-6)


def test_threads(run, ball, lamina, monkeypatch):
    """The preferences' without the option. The images do not depend on them."""
    from bl_ext.user_default.lamina.base import preferences
    from bl_ext.user_default.lamina.interior import interior_job

    whole, seen = interior_job.compute, []

    def watched(task, *more):
        seen.append(task.threads)
        return whole(task, *more)

    monkeypatch.setattr(interior_job, "compute", watched)
    for arguments in (("--threads", 1), ()):
        assert run("Ball", "--size", 4, *arguments)[0] == 0
    assert seen == [1, preferences.threads()] != [1, 1]


def test_an_interruption_keeps_parts(run, ball, addon, lamina, monkeypatch):
    """The next call with the same settings continues after them."""
    from bl_ext.user_default.lamina.interior import interior_job

    from lamina.maps import part_folder

    monkeypatch.setattr(part_folder, "SAMPLES_PER_PART", 100)
    whole, said = interior_job.compute, []

    def interrupted(task, progress=None, cancel=None, *more):
        return whole(task, lambda _, text: said.append(text), lambda: said and said[-1].startswith("Part 4 of "), *more)

    monkeypatch.setattr(interior_job, "compute", interrupted)
    code, _, err = run("Ball", "--size", 12)
    assert code == 130 and "interrupted" in err and ball.active_material.lamina.interior.size == 64
    said.clear()
    monkeypatch.setattr(interior_job, "compute", lambda task, progress=None, cancel=None, *more: whole(
        task, lambda _, text: said.append(text), cancel, *more))  # fmt: skip
    code, lines, _ = run("Ball", "--size", 12)
    assert code == 0 and lines[0].startswith("Ball: Colors and radii: ")
    assert not any(text.startswith("Part 3 of ") for text in said)


def test_frames_with_a_moving_lamp_and_a_bending_body(run, ball, tmp_path):
    scene = bpy.context.scene
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    scene.collection.objects.link(sun)
    ball.shape_key_add(name="Basis")
    long = ball.shape_key_add(name="Long")
    for corner in long.data:
        corner.co.x *= 3.0
    for frame, turn, share in ((1, 0.0, 0.0), (3, 2.4, 1.0)):
        sun.rotation_euler.x, long.value = turn, share
        sun.keyframe_insert("rotation_euler", frame=frame)
        long.keyframe_insert("value", frame=frame)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location.z, camera.data.type, camera.data.ortho_scale = 1.0, "ORTHO", 0.08
    scene.collection.objects.link(camera)
    scene.camera, render = camera, scene.render
    render.engine, render.resolution_x, render.resolution_y = "CYCLES", 16, 16
    scene.cycles.samples, scene.frame_step, render.use_overwrite = 4, 2, False
    render.film_transparent, render.image_settings.file_format = True, "PNG"
    render.image_settings.color_mode = "RGBA"
    output = render.filepath = str(tmp_path / "turn_##")
    code, lines, err = run("Ball", "--kind", "lit", "--size", 12, "--frames", 1, 4)
    assert code == 0, err
    told = [line for line in lines if line.startswith(("Ball: Light: ", "frame "))]
    assert len(told) == 4 and render.filepath == output
    shown = [pixels(bpy.data.images.load(str(tmp_path / f"turn_0{frame}.png"))) for frame in (1, 3)]
    covered = [(picture[..., 3] > 0.5).sum() for picture in shown]
    assert covered[1] > 1.8 * covered[0] > 0, "the shape of the frame"
    light = [picture[picture[..., 3] > 0.5][:, :3].mean() for picture in shown]
    assert light[0] > 1.2 * light[1], "the lamp of the frame"
    (tmp_path / "turn_01.png").unlink()
    code, lines, _ = run("Ball", "--kind", "lit", "--size", 12, "--frames", 1, 4)
    rendered = [line for line in lines if line.startswith("frame ")]
    assert code == 0 and rendered == [f"frame 1: {tmp_path / 'turn_01.png'}"]


def test_control_c_in_a_render(run, ball, tmp_path):
    """Blender drops what is raised in Python code that it calls: the frame ends, and no further one begins."""
    scene = bpy.context.scene
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(scene.camera)
    render = scene.render
    render.engine, render.resolution_x, render.resolution_y, scene.cycles.samples = "CYCLES", 4, 4, 1
    render.filepath = str(tmp_path / "turn_##")

    def press(*_):  # in the frame's render alone: before it, textures are rendered
        if render.filepath.endswith("turn_01.png"):
            signal.raise_signal(signal.SIGINT)

    bpy.app.handlers.render_pre.append(press)
    try:
        code, lines, err = run("Ball", "--size", 12, "--frames", 1, 3)
    finally:
        bpy.app.handlers.render_pre.remove(press)
    assert code == 130 and err == "lamina: interrupted: frames rendered: 1\n"
    assert [path.name for path in tmp_path.iterdir()] == ["turn_01.png"] and lines[-1].startswith("frame 1: ")


def test_frames_that_cannot_be_rendered(run, ball, tmp_path):
    scene = bpy.context.scene
    scene.render.filepath = str(tmp_path / "turn_##")
    code, lines, err = run("Ball", "--kind", "lit", "--size", 12, "--frames", 1, 2)
    assert (code, lines) == (1, []) and err == "lamina: frame 1 cannot be rendered: the scene has no camera\n"
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(scene.camera)
    scene.collection.objects.link(bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN")))
    (tmp_path / "file").touch()
    scene.render.filepath = str(tmp_path / "file" / "turn_##")
    code, _, err = run("Ball", "--kind", "lit", "--size", 12, "--frames", 1, 2)
    assert code == 1 and "lamina: frame 1 cannot be rendered: " in err
    assert scene.render.filepath == str(tmp_path / "file" / "turn_##")


@pytest.mark.parametrize(("arguments", "words"), [
    (("--frames", 3, 1), "the first frame comes after the last one"),
    (("--frames", 1, 2, "--output", "out.blend"), "leave out --save and --output"),
    (("--frames", 1), "expected 2 arguments"), (("--frames", 1, "x"), "'x': must be a whole number")])
def test_bad_frames(run, ball, arguments, words):
    code, lines, err = run("Ball", *arguments)
    assert code == 2 and words in err and not lines


def test_frames_are_not_a_movie(run, ball):
    settings = bpy.context.scene.render.image_settings
    if hasattr(settings, "media_type"):  # Blender 5.0
        settings.media_type = "VIDEO"
    settings.file_format = "FFMPEG"
    code, _, err = run("Ball", "--frames", 1, 2)
    assert code == 2 and "is a movie" in err
