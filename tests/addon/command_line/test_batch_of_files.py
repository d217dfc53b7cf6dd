# SPDX-License-Identifier: GPL-3.0-or-later
"""Many files in one command: which are baked, skipped, saved and refused, and what the batch tells of them."""

import json
import os
import re
import shutil
import socket
import sys
from pathlib import Path
from types import SimpleNamespace

import bpy
import pytest
from batch_files import baked, held, in_another_process, make

LINE = re.compile(r": fit error [\d.e-]+ %, worst slice [\d.e-]+ %, \d+ closures, standard, preview, [\d.]+ s$")


@pytest.fixture
def bakes(lamina, monkeypatch):
    """The hashes of the stacks that this process bakes, in sequence."""
    found, real = [], lamina.bake

    def bake(stack, **arguments):
        found.append(stack.hash)
        return real(stack, **arguments)

    monkeypatch.setattr(lamina, "bake", bake)
    return found


@pytest.fixture
def files(addon, lamina, tmp_path):
    """Two files; dusty_a is the same in both."""
    return [
        make(addon, tmp_path / "one.blend", {"dusty_a": 0.2, "dusty_b": 0.3, "plain": None}),
        make(addon, tmp_path / "two.blend", {"dusty_a": 0.2, "wall": 0.4}),
    ]


def statuses(manifest):
    """{(file, material): status}"""
    data = json.loads(manifest.read_text())
    return {(os.path.basename(one["file"]), one["material"]): one["status"] for one in data["materials"]}


def test_files_and_patterns_and_materials(run, files, bakes, tmp_path):
    code, lines, _ = run("bake", tmp_path / "*.blend", "--materials", "dusty_*", "--save")
    assert code == 0 and baked(files[0]) == {"dusty_a", "dusty_b"} and baked(files[1]) == {"dusty_a"}
    assert len(bakes) == 2, "equal stacks are baked once"
    one, two = files
    expected = [f"{one}: dusty_a: fit", f"{one}: dusty_b: fit", f"{one}: saved", f"{two}: dusty_a: fit",
                f"{two}: saved"]  # fmt: skip
    assert [line[: len(start)] for line, start in zip(lines, expected, strict=False)] == expected
    assert [bool(LINE.search(line)) for line in lines] == [True, True, False, True, False, False]
    assert lines[-1] == "lamina: 2 files; materials: 2 baked, 1 from the cache"
    assert run("bake", files[1], "wall", "--save")[0] == 0 and baked(files[1]) == {"dusty_a", "wall"}


def test_the_second_run_does_nothing(run, files, bakes, tmp_path, finished_bakes):
    manifest = tmp_path / "out.json"
    assert run("bake", *files, "--save", "--manifest", manifest)[0] == 0
    assert statuses(manifest) == {
        ("one.blend", "dusty_a"): "baked", ("one.blend", "dusty_b"): "baked",
        ("two.blend", "dusty_a"): "from the cache", ("two.blend", "wall"): "baked"}  # fmt: skip
    before = [(file.read_bytes(), os.stat(file).st_mtime_ns) for file in files]
    shutil.rmtree(finished_bakes)
    bakes.clear()
    code, lines, _ = run("bake", *files, "--save", "--manifest", manifest)
    assert code == 0 and bakes == [] and [(file.read_bytes(), os.stat(file).st_mtime_ns) for file in files] == before
    assert set(statuses(manifest).values()) == {"up to date"}
    assert f"{files[0]}: unchanged" in lines and f"{files[0]}: dusty_a: up to date" in lines
    assert run("bake", *files, "--save", "--force")[0] == 0 and len(bakes) == 3, "--force bakes each stack once"


@pytest.mark.parametrize("change", ["layers", "quality", "basis", "version", "pixels", "nodes"])
def test_only_what_is_out_of_date_is_baked(run, addon, files, change, tmp_path, monkeypatch):
    """In the open file: a changed stack, quality, basis or version, a lost image, a deleted node."""
    changes = addon.base.native.part("baking.report.result_changes")
    manifest = tmp_path / "out.json"
    assert run("bake", files[0], "--save", "--force")[0] == 0
    material, more = bpy.data.materials["dusty_b"], []
    if change == "layers":
        material.lamina.layers[0].tau = 0.9
    elif change == "quality":
        material.lamina.quality = "final"
    elif change == "basis":
        more = ["--materials", "dusty_b", "--basis", "accurate"]
    elif change == "version":
        material.lamina.result.version = ""
        monkeypatch.setattr(changes._core, "__version__", "0.3.0")
        told = changes.Change("0.2.0", "sheets of dust", lambda stack: stack.hash == material.lamina.result.stack_hash)
        monkeypatch.setattr(changes, "CHANGES", (told,))
        assert run("list")[1][1] == (
            "dusty_b: 1 layer, out of date, baked by 0.1.0 or earlier; 0.2.0 changed sheets of dust")
    elif change == "pixels":
        image = next(node.image for node in material.lamina.node_group.nodes if node.type == "TEX_IMAGE")
        image.unpack(method="REMOVE")
    else:
        material.node_tree.nodes.clear()
    assert run("bake", *more, "--manifest", manifest)[0] == 0
    data = json.loads(manifest.read_text())["materials"]
    found = {one["material"]: one for one in data}
    assert found["dusty_b"]["status"] in ("baked", "from the cache") and found["dusty_b"]["reason"]
    assert "dusty_a" not in found or found["dusty_a"]["status"] == "up to date"
    if change in ("layers", "quality", "version"):
        assert run("list")[1] == ["dusty_a: 1 layer, up to date", "dusty_b: 1 layer, up to date"]
    assert run("bake", *more, "--manifest", manifest)[0] == 0
    assert set(statuses(manifest).values()) == {"up to date"}, "the new bake is fresh"


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no device stands for a full disk")
def test_a_log_on_a_full_disk(run, files):
    """It is told, and the batch is as successful as without the log."""
    code, _, err = run("bake", files[0], "dusty_a", "--save", "--log", "/dev/full")
    assert code == 0 and baked(files[0]) == {"dusty_a"}
    assert err == "lamina: --log /dev/full: No space left on device\n"


@pytest.mark.skipif(sys.platform != "linux", reason="other systems refuse such names")
def test_a_file_name_that_is_no_text(files, tmp_path):
    """The log shows it, and the batch goes on."""
    odd, log = Path(os.fsdecode(os.fsencode(tmp_path) + b"/odd-\xff.blend")), tmp_path / "out.log"
    files[0].rename(odd)
    process = in_another_process("bake", odd, files[1], "--save", "--log", log,
                                 before="sys.stdout.reconfigure(errors='backslashreplace')")  # fmt: skip
    with process:  # Blender prints the name's bytes, which are no text
        assert process.wait(timeout=120) == 0, process.stderr.read()
    assert baked(odd) == {"dusty_a", "dusty_b"} and baked(files[1]) == {"dusty_a", "wall"}
    assert "odd-\\udcff.blend: saved" in log.read_text(encoding="utf-8")


def test_the_manifest_and_the_log(run, lamina, files, tmp_path):
    manifest, log = tmp_path / "out.json", tmp_path / "out.log"
    log.write_text("earlier\n")
    code, lines, _ = run("bake", *files, "--materials", "dusty_a", "plain", "--save", "--manifest", manifest,
                         "--log", log)  # fmt: skip
    data = json.loads(manifest.read_text())
    assert code == 1 and data["exit_code"] == 1 and data["lamina"] == lamina.__version__
    assert data["blender"] == bpy.app.version_string and not data["dry_run"] and data["seconds"] > 0.0
    assert [(one["file"], one["status"]) for one in data["files"]] == [(str(file), "saved") for file in files]
    first, plain, second = data["materials"]
    material = bpy.data.materials["dusty_a"]
    assert first["stack_hash"] == second["stack_hash"] == material.lamina.result.stack_hash
    assert (first["status"], second["status"], first["reason"]) == ("baked", "from the cache", "not baked")
    assert first["baked"]["errors"]["fit_error"] == material.lamina.result.report["fit_error"] > 0.0
    assert first["baked"]["errors"]["fit_error_transmission"] is None and first["seconds"] > 0.0
    assert (first["quality"], first["basis"]) == ("preview", "standard")
    assert first["baked"]["lamina"] == lamina.__version__ == material.lamina.result.version
    assert plain["status"] == "failed" and plain["reason"] == "has no Lamina layers (give --stack JSON)"
    logged = log.read_text().splitlines()
    time = re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\+00:00 ")
    assert logged[0] == "earlier" and all(time.match(line) for line in logged[1:])
    assert [line.split(" ", 1)[1] for line in logged[1:-1]] == lines and logged[-1].endswith("exit code 1")


def test_a_dry_run_changes_nothing(run, files, bakes, tmp_path, finished_bakes):
    assert run("bake", files[0], "dusty_a", "--save")[0] == 0
    bakes.clear()
    names, manifest = sorted(os.listdir(tmp_path)), tmp_path / "out.json"
    contents, kept = [file.read_bytes() for file in files], os.listdir(finished_bakes)
    code, lines, _ = run("bake", *files, "--save", "--dry-run", "--manifest", manifest)
    assert code == 0 and bakes == [] and [file.read_bytes() for file in files] == contents
    assert sorted(os.listdir(tmp_path)) == sorted([*names, "out.json"]) and os.listdir(finished_bakes) == kept
    assert statuses(manifest) == {
        ("one.blend", "dusty_a"): "up to date", ("one.blend", "dusty_b"): "to be baked",
        ("two.blend", "dusty_a"): "in the cache", ("two.blend", "wall"): "to be baked"}  # fmt: skip
    assert f"{files[0]}: dusty_b: to be baked (not baked)" in lines and json.loads(manifest.read_text())["dry_run"]
    code, lines, _ = run("bake", files[0], "plain", "--dry-run")
    assert code == 1 and f"{files[0]}: plain: would fail: has no Lamina layers (give --stack JSON)" in lines


def test_a_dry_run_of_other_layers_leaves_the_open_file_as_it_is(run, addon, files, tmp_path):
    bpy.ops.wm.open_mainfile(filepath=str(files[0]))
    path = tmp_path / "ash.json"
    path.write_text(json.dumps({"schema": 1, "layers": [], "base": {"kind": "lambert", "reflectance": 0.2}}))
    before = addon.editing.stack_io.to_dict(bpy.data.materials["dusty_a"])
    assert run("bake", "dusty_a", "plain", "--stack", path, "--dry-run")[0] == 0
    assert addon.editing.stack_io.to_dict(bpy.data.materials["dusty_a"]) == before
    assert not bpy.data.materials["plain"].lamina.enabled


def test_an_output_folder(run, files, tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    contents = [file.read_bytes() for file in files]
    assert run("bake", *files, "--output", folder)[0] == 0
    assert [file.read_bytes() for file in files] == contents
    assert baked(folder / "one.blend") == {"dusty_a", "dusty_b"} and baked(folder / "two.blend") == {"dusty_a", "wall"}
    code, lines, _ = run("bake", *files, "--output", folder)
    assert code == 0 and lines[-1] == "lamina: 2 files; materials: 4 from the cache"


def test_one_bad_file_does_not_stop_the_others(run, addon, files, tmp_path):
    bad = tmp_path / "bad.blend"
    bad.write_bytes(b"not a blend")
    manifest = tmp_path / "out.json"
    code, lines, error = run("bake", bad, *files, "--save", "--manifest", manifest)
    assert code == 1 and baked(files[0]) and baked(files[1]) and bad.read_bytes() == b"not a blend"
    assert any(line.startswith(f"{bad}: failed: {bad} cannot be opened: ") for line in lines) and error == ""
    assert [one["status"] for one in json.loads(manifest.read_text())["files"]] == ["failed", "saved", "saved"]
    assert not list(tmp_path.glob("*.lamina-lock")) and not list(tmp_path.glob(".*.lamina-lock"))


def test_a_file_that_another_batch_bakes_is_left_alone(run, files):
    lock = files[0].with_name(".one.blend.lamina-lock")
    lock.write_text(json.dumps({"pid": os.getppid(), "host": socket.gethostname()}))
    contents = files[0].read_bytes()
    code, lines, _ = run("bake", *files, "--save")
    assert code == 1 and files[0].read_bytes() == contents and baked(files[1]) == {"dusty_a", "wall"}
    assert lines[0].startswith(f"{files[0]}: failed: {files[0]} is being baked by process {os.getppid()} on ")
    lock.unlink()
    assert run("bake", *files, "--save")[0] == 0 and baked(files[0]) == {"dusty_a", "dusty_b"}


def test_a_lock_whose_owner_was_killed_is_taken_over(run, files):
    """Even if another process has its number by now: the operating system's lock is gone."""
    lock = files[0].with_name(".one.blend.lamina-lock")
    lock.write_text(json.dumps({"pid": os.getppid(), "host": socket.gethostname(), "locked": True}))
    assert run("bake", files[0], "--save")[0] == 0 and not lock.exists()


def test_names_that_no_file_has(run, files):
    code, lines, error = run("bake", *files, "--materials", "wall", "roof*", "--save")
    assert code == 1 and baked(files[1]) == {"wall"}
    assert error == "lamina: no material with layers matches 'roof*' in any file\n"
    assert run("bake", *files, "--materials", "wall", "--save")[0] == 0, "a file without the material is no error"


def test_the_disk_must_have_room_for_the_tables(run, files, bakes, monkeypatch):
    """The file alone would fit."""
    room = os.stat(files[0]).st_size + 10_000
    monkeypatch.setattr(shutil, "disk_usage", lambda path: SimpleNamespace(free=room))
    code, lines, _ = run("bake", files[0], "--save")
    assert code == 1 and bakes == [] and f"the disk of {files[0].parent} is full" in lines[0]


def test_a_file_grows_no_more_than_estimated(run, addon, files):
    """A varying layer with many closures over a textured base."""
    bpy.ops.wm.open_mainfile(filepath=str(files[0]))
    settings = bpy.data.materials["dusty_a"].lamina
    settings.layers[0].varying, settings.base.textured = True, True
    bpy.data.materials["dusty_b"].lamina.enabled = False
    bpy.ops.wm.save_mainfile()
    size = os.stat(files[0]).st_size
    arguments = addon.command_line.arguments.parse(["bake", "--basis", "accurate"])
    growth = addon.command_line.plan.Plan(bpy.data.materials["dusty_a"], None, arguments).growth
    assert run("bake", files[0], "--basis", "accurate", "--save")[0] == 0
    assert 0.02 * growth < os.stat(files[0]).st_size - size <= growth


def test_list_of_files_as_json(run, addon, lamina, files):
    assert run("bake", files[0], "dusty_a", "--save")[0] == 0
    code, lines, _ = run("list", *files)
    assert code == 0 and lines == [
        f"{files[0]}: dusty_a: 1 layer, up to date", f"{files[0]}: dusty_b: 1 layer, not baked",
        f"{files[1]}: dusty_a: 1 layer, not baked", f"{files[1]}: wall: 1 layer, not baked"]  # fmt: skip
    code, lines, _ = run("list", *files, "--json")
    data = json.loads(lines[0])
    assert code == 0 and len(lines) == 1 and [one["state"] for one in data["materials"]] == ["fresh", *["none"] * 3]
    first, second = data["materials"][:2]
    assert first["file"] == str(files[0]) and first["baked"]["stack_hash"] == first["stack_hash"]
    assert first["baked"]["lamina"] == lamina.__version__ and second["baked"] is None


def test_list_and_bake_agree_on_a_group_without_its_tables(run, files):
    assert run("bake", files[0], "dusty_a", "--save")[0] == 0
    bpy.ops.wm.open_mainfile(filepath=str(files[0]))
    group = bpy.data.materials["dusty_a"].lamina.node_group
    next(node.image for node in group.nodes if node.type == "TEX_IMAGE").unpack(method="REMOVE")
    code, lines, _ = run("list")
    assert code == 0 and lines[0] == "dusty_a: 1 layer, the node group of the last bake is not whole"
    assert json.loads(run("list", "--json")[1][0])["materials"][0]["state"] == "broken"
    code, lines, _ = run("bake", "dusty_a", "--dry-run")
    assert code == 0 and "in the cache (the node group of the last bake is not whole)" in lines[0]


def test_the_group_tells_which_lamina_baked_it(run, lamina, files):
    assert run("bake", files[0], "dusty_a", "--save")[0] == 0
    assert bpy.data.materials["dusty_a"].lamina.node_group["lamina_version"] == lamina.__version__


def test_version(run, lamina):
    assert run("--version")[:2] == (0, [f"lamina {lamina.__version__}, Blender {bpy.app.version_string}"])


BAD = {
    "no such file": (["bake", "/nowhere/*.blend"], "no file matches '/nowhere/*.blend'"),
    "one name for two": (["bake", "{one}", "{two}", "--output", "x.blend"],
                         "must be a folder, because there are 2 files"),
    "jobs": (["bake", "--jobs", "0"], "must be a whole number from 1 to 256"),
    "manifest": (["bake", "{one}", "--manifest", "/nowhere/x.json"], "--manifest /nowhere/x.json: No such file"),
    "log": (["bake", "{one}", "--log", "/nowhere/x.log"], "--log /nowhere/x.log: No such file"),
    "cache": (["bake", "{one}", "--cache", "/sys/lamina"], "finished bakes cannot be kept in /sys/lamina"),
    "list of a material": (["list", "wall"], "wall: must end in .blend"),
    "stack for all": (["bake", "{one}", "--over"], "--stack and --over need names"),
}  # fmt: skip


@pytest.mark.parametrize(("arguments", "sentence"), BAD.values(), ids=BAD)
def test_bad_arguments_are_one_sentence(run, files, bakes, arguments, sentence):
    code, lines, error = run(*(one.format(one=files[0], two=files[1]) for one in arguments))
    assert code == 2 and lines == [] and bakes == []
    assert sentence in error and error.count("\n") == 1 and error.startswith("lamina: ")


def test_two_files_of_one_name_do_not_overwrite_each_other(run, files, tmp_path):
    (tmp_path / "more").mkdir()
    shutil.copy(files[0], tmp_path / "more")
    code, _, error = run("bake", files[0], tmp_path / "more" / "one.blend", "--output", tmp_path)
    assert code == 2 and "two files have the name one.blend" in error


def test_finished_bakes_without_a_chosen_folder(run, addon, files, tmp_path, monkeypatch):
    """They are kept in a folder of the extension's own, of limited size."""
    monkeypatch.delenv("LAMINA_CACHE")
    folder = tmp_path / "own"
    monkeypatch.setattr(addon.base.package, "user_folder", lambda name, create=False: folder / name)
    assert run("bake", files[0], "--save")[0] == 0 and len(list((folder / "bakes").iterdir())) == 2
    monkeypatch.setattr(addon.command_line.finished_tables, "MOST_BYTES", 1000)
    assert run("bake", files[1], "wall", "--save")[0] == 0 and len(list((folder / "bakes").iterdir())) == 1
    monkeypatch.setattr(addon.base.package, "user_folder", lambda name, create=False: Path("/sys/lamina"))
    code, lines, error = run("bake", *files, "--save", "--force")
    assert code == 0 and baked(files[1]) == {"dusty_a", "wall"}
    assert "finished bakes cannot be kept in /sys/lamina" in error


def test_a_full_disk_of_finished_bakes_loses_nothing(run, addon, files, monkeypatch):
    def save(self, lut):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(addon.base.native.part("baking.table.cache").LutCache, "save", save)
    code, _, error = run("bake", files[0], "--save")
    assert code == 0 and baked(files[0]) == {"dusty_a", "dusty_b"}
    assert "a finished bake could not be kept in" in error and "No space left on device" in error


def test_a_damaged_finished_bake_is_made_again(run, files, bakes, finished_bakes):
    assert run("bake", files[0], "dusty_a", "--save")[0] == 0
    (kept,) = finished_bakes.iterdir()
    whole = kept.read_bytes()
    kept.write_bytes(whole[:-200])
    bakes.clear()
    assert run("bake", files[1], "dusty_a", "--save")[0] == 0 and len(bakes) == 1 and kept.read_bytes() == whole
    assert held(files[0])[0]["dusty_a"] == held(files[1])[0]["dusty_a"]


def test_workspaces_stay(addon, lamina, tmp_path):
    """In a Blender that has just started: one that opened files before may have no windows of its own."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    bpy.data.workspaces[0].name = "Look"
    material = bpy.data.materials.new("dusty")
    addon.editing.layer_list.add_stack(material)
    material.use_fake_user, material.lamina.quality = True, "preview"
    file = tmp_path / "look.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(file))
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    assert in_another_process("bake", file, "--save").wait() == 0
    with bpy.data.libraries.load(str(file)) as (inside, _):
        assert "Look" in inside.workspaces
    assert baked(file) == {"dusty"}
