# SPDX-License-Identifier: GPL-3.0-or-later
"""`--command lamina ...`: baked materials, output, saved files and exit codes."""

import json
import os
import re
import signal
import subprocess
import sys
import textwrap
import time

import bpy
import own_blender
import pytest

LINE = re.compile(
    r"^(?P<name>.+): fit error [\d.e-]+ %, worst slice [\d.e-]+ %, \d+ closures, "
    r"(standard|accurate), (preview|final), [\d.]+ s$"
)
STACK = {"schema": 1, "layers": [{"kind": "medium", "name": "ash", "albedo": 0.4, "tau": 0.7,
         "phase": {"kind": "isotropic"}}], "base": {"kind": "black"}}  # fmt: skip


@pytest.fixture
def materials(addon):
    """wall_a, wall_b and floor with layers, plain without."""
    made = {}
    for name in ("wall_a", "wall_b", "floor"):
        made[name] = bpy.data.materials.new(name)
        made[name].use_fake_user = True
        addon.editing.layer_list.add_stack(made[name])
        made[name].lamina.quality = "preview"
    made["plain"] = bpy.data.materials.new("plain")
    made["plain"].use_fake_user = True
    return made


def baked(materials):
    return {name for name, material in materials.items() if material.lamina.result.stack_hash}


def test_all(run, materials):
    code, lines, error = run("bake")
    assert code == 0 and baked(materials) == {"wall_a", "wall_b", "floor"}
    assert [LINE.match(line)["name"] for line in lines] == ["floor", "wall_a", "wall_b"]
    assert "nothing was saved" in error


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (["floor"], {"floor"}),
        (["wall_*"], {"wall_a", "wall_b"}),
        (["wall_?", "floor", "wall_a"], {"wall_a", "wall_b", "floor"}),
        (["*"], {"wall_a", "wall_b", "floor"}),
    ],
)
def test_names_and_patterns(run, materials, names, expected):
    code, lines, _ = run("bake", *names)
    assert code == 0 and baked(materials) == expected and len(lines) == len(expected)


def test_a_name_with_brackets_is_a_name(run, materials):
    materials["floor"].name = "floor[1]"
    assert run("bake", "floor[1]")[0] == 0 and baked(materials) == {"floor"}


def test_quality_and_threads(run, materials):
    assert run("bake", "floor", "--quality", "preview", "--threads", "1")[0] == 0
    assert materials["floor"].lamina.result.quality == "preview"


def test_basis(run, addon, materials):
    assert run("bake", "floor", "--quality", "preview", "--basis", "accurate")[0] == 0
    assert materials["floor"].lamina.result.basis == addon.base.preferences.table_basis("accurate")
    assert materials["floor"].lamina.basis == "standard", "the material's own choice stays"


def test_stack_from_a_file(run, addon, materials, tmp_path):
    path = tmp_path / "ash.json"
    path.write_text(json.dumps(STACK))
    materials["plain"].lamina.quality = "preview"
    code, _, _ = run("bake", "plain", "floor", "--stack", path, "--quality", "preview")
    assert code == 0 and baked(materials) == {"plain", "floor"}
    assert addon.editing.stack_io.to_dict(materials["plain"])["layers"][0]["name"] == "ash"
    assert addon.baking.bake_job.state(materials["plain"]) == "fresh"


def test_one_fails_and_the_others_finish(run, addon, lamina, materials, monkeypatch, tmp_path):
    materials["wall_a"].lamina.layers[0].name = "bad"
    materials["wall_a"].lamina.layers[0].tau = 0.7  # the other two share one bake
    real = lamina.bake

    def bake(stack, **arguments):
        if stack.to_json()["layers"][0]["name"] == "bad":
            raise lamina.SolveError("layers[0]: did not converge")
        return real(stack, **arguments)

    monkeypatch.setattr(lamina, "bake", bake)
    target = tmp_path / "out.blend"
    code, lines, _ = run("bake", "--output", target)
    assert code == 1 and baked(materials) == {"wall_b", "floor"} and target.is_file()
    assert [line for line in lines if not LINE.match(line)] == [
        "wall_a: failed: Layer 1 “bad”: did not converge"
    ]


def test_an_empty_stack_and_a_plain_material_fail_by_name(run, materials):
    materials["wall_a"].lamina.layers.clear()
    materials["wall_a"].lamina.base.kind = "none"
    code, lines, _ = run("bake", "wall_a", "plain", "floor")
    assert code == 1 and baked(materials) == {"floor"}
    assert lines[0].startswith("wall_a: failed: ") and lines[1].startswith(
        "plain: failed: has no Lamina layers"
    )


def test_a_failed_bake_with_a_file_gives_the_old_layers_back(
    run, addon, lamina, materials, monkeypatch, tmp_path
):
    path = tmp_path / "ash.json"
    path.write_text(json.dumps(STACK))
    before = addon.editing.stack_io.to_dict(materials["floor"])

    def bake(stack, **_arguments):
        raise lamina.SolveError("did not converge")

    monkeypatch.setattr(lamina, "bake", bake)
    code, _, _ = run("bake", "floor", "plain", "--stack", path)
    assert code == 1 and addon.editing.stack_io.to_dict(materials["floor"]) == before
    assert not materials["plain"].lamina.enabled


def test_saving(run, materials, tmp_path):
    first, second = tmp_path / "first.blend", tmp_path / "second.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(first))
    assert run("bake", "floor", "--output", second)[0] == 0
    bpy.ops.wm.open_mainfile(filepath=str(second))
    assert bpy.data.materials["floor"].lamina.result.stack_hash
    bpy.ops.wm.open_mainfile(filepath=str(first))
    assert not bpy.data.materials["floor"].lamina.result.stack_hash
    assert run("bake", "floor", "--save")[0] == 0
    bpy.ops.wm.open_mainfile(filepath=str(first))
    assert bpy.data.materials["floor"].lamina.node_group is not None


BAD = {
    "no command": ([], "bake|dust|interior|list"),
    "unknown command": (["cook"], "invalid choice"),
    "unknown option": (["bake", "--fast"], "--fast"),
    "unknown quality": (["bake", "--quality", "best"], "'best'"),
    "threads": (["bake", "--threads", "-1"], "must be a whole number from 0 to 1024"),
    "threads text": (["bake", "--threads", "many"], "must be a whole number from 0 to 1024"),
    "no such material": (["bake", "roof"], "no material matches 'roof'"),
    "no such pattern": (["bake", "roof_*"], "no material matches 'roof_*'"),
    "pattern without layers": (["bake", "pl*n"], "no material that matches 'pl*n' has Lamina layers"),
    "stack for nobody": (["bake", "--stack", "x.json"], "--stack"),
    "no such stack": (["bake", "floor", "--stack", "/nowhere/x.json"], "/nowhere/x.json: No such file"),
    "no file open": (["bake", "--save"], "no .blend file is open"),
    "not a blend": (["bake", "--output", "x.exr"], "must end in .blend"),
    "no such folder": (["bake", "--output", "/nowhere/x.blend"], "there is no such folder"),
    "two targets": (["bake", "--save", "--output", "x.blend"], "not allowed with"),
}


@pytest.mark.parametrize(("arguments", "sentence"), BAD.values(), ids=BAD)
def test_bad_arguments_are_one_sentence(run, materials, arguments, sentence):
    code, lines, error = run(*arguments)
    assert code == 2 and lines == [] and baked(materials) == set()
    assert sentence in error and error.count("\n") == 1 and error.startswith("lamina: ")


def test_a_bad_stack_file_touches_nothing(run, addon, materials, tmp_path):
    path = tmp_path / "bad.json"
    path.write_text(json.dumps(STACK | {"layers": [STACK["layers"][0] | {"albedo": 1.5}]}))
    before = addon.editing.stack_io.to_dict(materials["floor"])
    code, lines, error = run("bake", "floor", "--stack", path)
    assert code == 2 and lines == [] and "albedo" in error and error.count("\n") == 1
    assert addon.editing.stack_io.to_dict(materials["floor"]) == before


def test_nothing_to_bake(run, addon):
    bpy.data.materials.new("plain")
    code, _, error = run("bake")
    assert code == 2 and "no material of this file has Lamina layers" in error
    assert run("list") == (0, [], "")


def test_help(run):
    code, lines, _ = run("bake", "--help")
    assert code == 0 and any("--stack" in line for line in lines)


def test_list(run, addon, materials):
    addon.baking.bake_job.bake_material(materials["floor"])
    addon.baking.bake_job.bake_material(materials["wall_a"])
    materials["wall_a"].lamina.layers[0].tau = 3.0
    addon.editing.layer_list.add_layer(materials["wall_b"])
    code, lines, _ = run("list")
    assert code == 0
    assert lines == [
        "floor: 1 layer, up to date",
        "wall_a: 1 layer, out of date",
        "wall_b: 2 layers, not baked",
    ]


def test_linked_materials(run, addon, materials, tmp_path):
    library = tmp_path / "library.blend"
    bpy.data.libraries.write(str(library), {materials["floor"]}, fake_user=True)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with bpy.data.libraries.load(str(library), link=True) as (_source, target):
        target.materials = ["floor"]
    assert run("bake")[0] == 2
    code, lines, _ = run("bake", "floor")
    assert code == 1 and lines == ["floor: failed: linked from another file: edit it there, or make it local"]


def test_patterns_skip_grease_pencil(run, addon, call):
    addon.nodes.node_tree.of(bpy.data.materials.new("glaze"))
    dots = bpy.data.materials.new("gp_dots")
    bpy.data.materials.create_gpencil_data(dots)
    code, lines, _ = run("bake", "g*", "--over", "--quality", "preview")
    assert code == 0 and len(lines) == 1 and lines[0].startswith("glaze: ")
    code, lines, _ = run("bake", "gp_dots", "--over")
    assert code == 1 and lines == ["gp_dots: failed: a Grease Pencil material"]
    with pytest.raises(RuntimeError, match="The material is a Grease Pencil material"):
        call(bpy.ops.lamina.add_stack, dots)


def test_layers_of_a_newer_lamina_are_left_alone(run, addon, materials):
    floor = materials["floor"]
    floor.lamina.schema = addon.properties.material_properties.SCHEMA + 1
    code, lines, _ = run("bake", "floor")
    assert code == 1 and lines == ["floor: failed: from a newer version of Lamina"]
    assert floor.lamina.node_group is None


def test_interrupted_in_process(run, addon, lamina, materials, monkeypatch, tmp_path):
    addon.baking.bake_job.bake_material(materials["floor"])
    before = materials["floor"].lamina.result.stack_hash
    materials["floor"].lamina.layers[0].tau = 5.0
    stopped = []

    def bake(stack, cancel=None, **_arguments):
        while not cancel():
            time.sleep(0.005)
        stopped.append(True)
        raise lamina.Cancelled

    def wait(self, seconds=None):
        if seconds is not None:
            raise KeyboardInterrupt
        self._thread.join()

    monkeypatch.setattr(lamina, "bake", bake)
    monkeypatch.setattr(addon.baking.bake_job.Job, "wait", wait)
    target = tmp_path / "out.blend"
    code, lines, error = run("bake", "floor", "--output", target)
    assert code == 130 and lines == [] and error == "lamina: interrupted: nothing was saved\n"
    assert stopped == [True] and not target.exists()
    assert materials["floor"].lamina.result.stack_hash == before


def test_control_c_leaves_nothing_half_done(addon, lamina, materials, tmp_path):
    """A real SIGINT to a real process, in the middle of a bake that would never end."""
    blend = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    before = blend.read_bytes()
    script = textwrap.dedent(f"""
        import os, sys, time
        import bpy, addon_utils
        addon = addon_utils.enable({own_blender.MODULE!r}, default_set=True)
        lamina = addon.base.native.require()
        def bake(stack, cancel=None, **arguments):
            print("BAKING", flush=True)
            while not cancel():
                time.sleep(0.01)
            raise lamina.Cancelled
        lamina.bake = bake
        bpy.ops.wm.open_mainfile(filepath={str(blend)!r})
        code = addon.command_line.command.main(["bake", "--save"])
        sys.stdout.flush(); sys.stderr.flush()
        os._exit(code)
    """)
    process = subprocess.Popen(
        [sys.executable, "-c", script],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ,
    )
    for line in process.stdout:
        if line.startswith("BAKING"):
            break
    process.send_signal(signal.SIGINT)
    _, error = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "interrupted: nothing was saved" in error and "Traceback" not in error
    assert blend.read_bytes() == before
    assert sorted(file.name for file in tmp_path.iterdir()) == ["scene.blend"]


def test_a_file_that_blender_could_not_read(run, monkeypatch):
    """Blender goes on with an empty file."""
    monkeypatch.setattr("sys.argv", ["blender", "-b", "gone.blend", "--command", "lamina", "list"])
    bpy.ops.wm.read_homefile(use_empty=True)
    code, lines, error = run("list")
    assert (code, lines, error) == (2, [], "lamina: gone.blend: Blender could not read this file\n")
