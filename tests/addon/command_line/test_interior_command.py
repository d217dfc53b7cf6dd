# SPDX-License-Identifier: GPL-3.0-or-later
"""`--command lamina interior ...`: images, settings, parts after an interruption, and exit codes."""

from functools import partial

import bpy
import pytest
from addon_helpers import icosphere


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
