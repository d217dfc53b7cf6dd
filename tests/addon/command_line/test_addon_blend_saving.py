# SPDX-License-Identifier: GPL-3.0-or-later
"""The save at the end of a batch: it gives the reason of a failure, is checked before the bake, and overwrites nobody's
work."""

import json
import os
import shutil
import socket
import subprocess
import sys
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from batch_files import baked, in_another_process


@pytest.fixture
def captured(capfd):
    """With what Blender itself prints."""
    return capfd


@pytest.fixture
def run(run):
    """run(*arguments) -> (exit code, lines about bakes, stderr)"""

    def about_bakes(*arguments):
        code, lines, error = run(*arguments)
        return code, [line for line in lines if ": fit error" in line], error

    return about_bakes


@pytest.fixture
def blend(addon, lamina, tmp_path):
    """A saved .blend that is open, with the unbaked materials first and second."""
    for name in ("first", "second"):
        made = bpy.data.materials.new(name)
        made.use_fake_user = True
        addon.editing.layer_list.add_stack(made)
        made.lamina.quality = "preview"
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def one_sentence(error):
    assert error.startswith("lamina: ") and error.count("\n") == 1, error
    return error


def on_open_file(blend, *arguments):
    """Exit code and stderr of a batch in a separate Blender that has opened this file."""
    opened = f"bpy.ops.wm.open_mainfile(filepath={str(blend)!r})"
    process = in_another_process(*arguments, before=opened)
    _, error = process.communicate(timeout=120)
    return process.returncode, error


def test_two_batches_on_one_file_lose_nothing(run, blend):
    """Both have opened the file; the other one saves first."""
    assert on_open_file(blend, "bake", "first", "--save")[0] == 0
    saved = blend.read_bytes()
    code, lines, error = run("bake", "second", "--save")
    aside = blend.with_name("scene.lamina-1.blend")
    assert code == 1 and len(lines) == 1 and blend.read_bytes() == saved
    assert f"{blend} has been changed by another program since it was opened" in one_sentence(error)
    assert f"this bake is saved as {aside}" in error
    assert {path.name for path in blend.parent.iterdir() if path.suffix == ".blend"} == {blend.name, aside.name}
    assert baked(blend) == {"first"} and baked(aside) == {"second"}


def test_an_output_that_changes_during_the_bake_is_left_alone(run, addon, blend, monkeypatch, tmp_path):
    target, real = tmp_path / "out.blend", addon.baking.bake_job.apply

    def apply(*arguments):
        shutil.copy(blend, target)
        return real(*arguments)

    shutil.copy(blend, target)
    os.utime(target, ns=(1, 1))
    monkeypatch.setattr(addon.baking.bake_job, "apply", apply)
    code, _, error = run("bake", "first", "--output", target)
    assert code == 1 and "since the bake began" in one_sentence(error) and target.read_bytes() == blend.read_bytes()
    assert baked(tmp_path / "out.lamina-1.blend") == {"first"}


def test_one_batch_after_the_other_is_no_conflict(run, blend, tmp_path):
    for name in ("first", "second"):
        assert run("bake", name, "--save")[0] == 0
        assert run("bake", name, "--output", tmp_path / "out.blend")[0] == 0
        bpy.ops.wm.open_mainfile(filepath=str(blend))
    assert baked(blend) == {"first", "second"}
    assert not [path for path in tmp_path.iterdir() if "lamina" in path.name]


def test_a_file_that_is_being_baked_is_refused_before_the_bake(run, blend):
    lock = blend.with_name(".scene.blend.lamina-lock")
    with subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE) as other:
        lock.write_text(json.dumps({"pid": other.pid, "host": socket.gethostname()}))
        code, lines, error = run("bake", "--save")
        other.communicate(b"\n")
    assert code == 1 and lines == [] and lock.exists()
    assert f"is being baked by process {other.pid} on {socket.gethostname()}" in one_sentence(error)
    assert run("bake", "first", "--save")[0] == 0, "the process has ended, and its lock counts no more"
    assert not lock.exists()
    lock.write_text(json.dumps({"pid": 1, "host": "another machine"}))
    assert f"delete {lock} if there is no such process" in run("bake", "--save")[2]
    lock.write_text("")
    assert "is being baked by another process" in run("bake", "--save")[2]


def test_the_lock_is_there_while_the_bake_lasts_and_no_longer(run, addon, lamina, blend, monkeypatch):
    seen, lock = [], blend.with_name(".scene.blend.lamina-lock")

    def bake(stack, **_arguments):
        seen.append(lock.exists())
        raise lamina.SolveError("did not converge")

    monkeypatch.setattr(lamina, "bake", bake)
    assert run("bake", "--save")[0] == 1
    assert seen == [True, True] and not lock.exists()


def test_a_place_that_cannot_be_written_is_noticed_before_the_bake(run, blend):
    """Nobody may make files there, not even root."""
    code, lines, error = run("bake", "first", "--output", "/sys/out.blend")
    assert code == 1 and lines == []
    assert one_sentence(error).startswith("lamina: /sys/out.blend cannot be saved: /sys: ")
    folder = blend.parent / "folder.blend"
    folder.mkdir()
    sentence = f"lamina: {folder} cannot be saved: it is a folder\n"
    assert run("bake", "first", "--output", folder) == (1, [], sentence)


def test_a_read_only_file_is_noticed_before_the_bake(run, addon, blend, monkeypatch):
    real = os.access
    monkeypatch.setattr(os, "access", lambda path, mode: path != blend and real(path, mode))  # root may write any file
    assert run("bake", "--save") == (1, [], f"lamina: {blend} cannot be saved: the file is read-only\n")


def test_a_disk_without_room_is_noticed_before_the_bake(run, blend, monkeypatch):
    monkeypatch.setattr(shutil, "disk_usage", lambda path: SimpleNamespace(free=1000))
    code, lines, error = run("bake", "--save")
    assert code == 1 and lines == []
    assert f"cannot be saved: the disk of {blend.parent} is full, 0.0 MB free, about " in one_sentence(error)


def test_a_disk_that_fills_up_during_the_bake(run, addon, blend, monkeypatch):
    """Blender's own message is then 'Error: Success'."""
    room = iter([10**9, 10, 10])
    monkeypatch.setattr(shutil, "disk_usage", lambda path: SimpleNamespace(free=next(room)))

    def save(path, copy):
        raise RuntimeError("Error: Success\n")

    monkeypatch.setattr(addon.command_line.blend_saving, "_save_by_blender", save)
    before = blend.read_bytes()
    code, lines, error = run("bake", "first", "--save")
    assert code == 1 and len(lines) == 1 and blend.read_bytes() == before
    assert "could not be saved: the disk of " in one_sentence(error) and "Success" not in error
    assert [path.name for path in blend.parent.iterdir()] == ["scene.blend"]


def test_any_failed_save_exits_with_1_and_a_reason(run, addon, blend, monkeypatch):
    cases = (("Error: Success\n", "Blender names no reason"), ("Error: Broken pipe", "Broken pipe"), ("", "no reason"))
    for words, told in cases:

        def save(path, copy, words=words):
            raise RuntimeError(words)

        monkeypatch.setattr(addon.command_line.blend_saving, "_save_by_blender", save)
        code, _, error = run("bake", "first", "--save")
        assert code == 1 and told in one_sentence(error)


@pytest.fixture
def small_disk(tmp_path):
    """A folder on a separate disk of 900 KB."""
    folder = tmp_path / "disk"
    folder.mkdir()
    made = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=900k", "tmpfs", folder], capture_output=True)
    if made.returncode:
        pytest.skip("only root may mount a small disk")
    yield folder
    subprocess.run(["umount", "-l", folder], check=True)


def test_a_disk_that_is_really_full(run, blend, small_disk):
    picture = bpy.data.images.new("Noise", 512, 512, float_buffer=True)
    picture.use_fake_user = True
    # Random numbers: from 5.2 on Blender compresses files unless told otherwise.
    picture.pixels.foreach_set(np.random.default_rng(1).random(512 * 512 * 4, np.float32))
    picture.pack()
    target = small_disk / "out.blend"
    code, lines, error = run("bake", "first", "--output", target)
    assert code == 1 and len(lines) == 1 and "could not be saved: the disk of" in one_sentence(error)
    assert list(small_disk.iterdir()) == []


@pytest.mark.parametrize("arguments", [["--save"], ["--output", "link"]])
def test_a_symbolic_link_stays_and_its_file_is_saved(run, blend, tmp_path, arguments):
    """The link stands in another folder, from which the file was opened."""
    folder = tmp_path / "links"
    folder.mkdir()
    link, manifest = folder / "link.blend", tmp_path / "manifest.json"
    link.symlink_to(blend)
    if arguments == ["--save"]:
        bpy.ops.wm.open_mainfile(filepath=str(link))
    else:
        arguments = ["--output", link]
    assert run("bake", "first", *arguments, "--manifest", manifest)[0] == 0
    assert link.is_symlink() and [path.name for path in folder.iterdir()] == ["link.blend"]
    assert baked(blend) == {"first"} and not blend.is_symlink()
    assert [one["output"] for one in json.loads(manifest.read_text())["files"]] == [str(blend)]
