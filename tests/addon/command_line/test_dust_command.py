# SPDX-License-Identifier: GPL-3.0-or-later
"""`--command lamina dust ...`: dust, its removal, the saved file, and exit codes."""

from functools import partial

import bpy
import pytest


@pytest.fixture
def run(run):
    """run(*arguments) -> (exit code, lines of stdout, stderr) of `dust`"""
    return partial(run, "dust")


@pytest.fixture
def cubes(addon, lamina):
    """Two grey cubes with one material."""
    material = bpy.data.materials.new("Grey")
    addon.nodes.node_tree.of(material)
    for number in range(2):
        bpy.ops.mesh.primitive_cube_add(location=(4.0 * number, 0.0, 0.0))
        bpy.context.object.name = f"Cube {number}"
        bpy.context.object.data.materials.append(material)
    bpy.context.view_layer.update()
    return [bpy.data.objects[f"Cube {number}"] for number in range(2)]


def test_dust_is_saved_and_removed(run, cubes, tmp_path):
    target = tmp_path / "dusty.blend"
    code, lines, _ = run("--amount", "0.5", "--output", target)
    assert (code, lines) == (0, ["Dust lies on 2 objects; 1 bake"])
    bpy.ops.wm.open_mainfile(filepath=str(target))
    objects = [bpy.data.objects[f"Cube {number}"] for number in range(2)]
    assert [obj.lamina_dust.largest for obj in objects] == pytest.approx([0.5, 0.5], rel=0.02)
    code, lines, err = run("--remove")
    assert code == 0 and lines == ["dust removed from 2 objects"] and "nothing was saved" in err
    assert not bpy.data.materials["Grey"].lamina.enabled


def test_some_objects_and_what_gets_no_dust(run, cubes):
    cubes[0].data.materials[0].node_tree.nodes.clear()
    code, lines, _ = run("Cube 1")
    assert code == 1
    assert lines == ["Dust lies on 1 object; Grey: No shader is linked to the Surface of the material output"]
    assert not cubes[0].lamina_dust.told


@pytest.mark.parametrize(("arguments", "code", "words"), [
    (("Sphere",), 2, "no mesh object of the scene matches 'Sphere'"),
    (("--amount", "-1"), 2, "--amount"),
    (("--amount", "nan"), 2, "argument --amount: 'nan': must be a number from 0 to 1000"),
    (("--threads", "-1"), 2, "--threads"),
    (("--save",), 2, "--save: no .blend file is open"),
])  # fmt: skip
def test_bad_arguments_are_one_sentence(run, cubes, arguments, code, words):
    found, lines, err = run(*arguments)
    assert found == code and words in err and not lines and not bpy.data.materials["Grey"].lamina.enabled


def test_a_scene_without_meshes(run, addon, lamina):
    code, lines, err = run()
    assert code == 1 and not lines and "There is no mesh object for dust to settle on" in err
