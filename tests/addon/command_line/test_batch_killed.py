# SPDX-License-Identifier: GPL-3.0-or-later
"""Batches that are killed and run again, or run by several processes, end with the same files as an undisturbed one."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import bpy
import pytest
from batch_files import baked, held, in_another_process, make

# Ends the process by SIGKILL when it has finished a number of bakes and begins the next one.
KILL = """
real, left = lamina.bake, [{count}]
def bake(stack, **arguments):
    if not left[0]:
        os.kill(os.getpid(), signal.SIGKILL)
    left[0] -= 1
    return real(stack, **arguments)
lamina.bake = bake
"""


@pytest.fixture
def run(run):
    """run(*arguments) -> (exit code, lines about bakes)"""

    def about_bakes(*arguments):
        code, lines, _ = run(*arguments)
        return code, [line for line in lines if ": fit error" in line or "failed" in line]

    return about_bakes


@pytest.fixture
def files(addon, lamina, tmp_path):
    """Two files of two materials each."""
    return [
        make(addon, tmp_path / "one.blend", {"dusty_a": 0.2, "dusty_b": 0.3}),
        make(addon, tmp_path / "two.blend", {"dusty_a": 0.5, "wall": 0.4}),
    ]


def copies(files, folder):
    folder.mkdir()
    return [Path(shutil.copy(file, folder)) for file in files]


def use(monkeypatch, folder):
    """Keep finished bakes in this folder from now on. Returns a function: {name: bytes} of the tables there."""
    monkeypatch.setenv("LAMINA_CACHE", str(folder))
    return lambda: {path.name: path.read_bytes() for path in folder.iterdir()}


def test_killed_twice_it_ends_as_if_undisturbed(run, files, tmp_path, monkeypatch):
    """At the second bake of the first file, and at the first one of the second file."""
    undisturbed = copies(files, tmp_path / "undisturbed")
    tables = use(monkeypatch, tmp_path / "tables")
    assert run("bake", *undisturbed, "--save")[0] == 0
    expected, expected_tables = [held(file) for file in undisturbed], tables()
    tables = use(monkeypatch, tmp_path / "killed")
    for count, finished in ((1, 1), (1, 2)):
        process = in_another_process("bake", *files, "--save", before=KILL.format(count=count))
        process.communicate(timeout=120)
        assert process.returncode == -signal.SIGKILL and len(tables()) == finished, "no finished bake is lost"
    assert baked(files[0]) == {"dusty_a", "dusty_b"} and baked(files[1]) == set()
    code, lines = run("bake", *files, "--save")
    assert code == 0 and len(lines) == 2, "the first file was saved before the second kill"
    assert [held(file) for file in files] == expected and tables() == expected_tables
    assert not list(tmp_path.glob(".*.lamina-lock"))


def test_the_number_of_processes_and_threads_does_not_matter(run, files, tmp_path, monkeypatch):
    twice = copies(files, tmp_path / "twice")
    found = []
    for name, chosen, arguments in (("one", files, ["--threads", 1]), ("two", twice, ["--jobs", 2, "--threads", 2])):
        tables = use(monkeypatch, tmp_path / name)
        code, lines = run("bake", *chosen, "--save", *arguments)
        assert code == 0 and len(lines) == 4
        found.append(([held(file) for file in chosen], tables()))
    assert found[0] == found[1] and len(found[0][1]) == 4


def test_processes_do_the_bakes_and_their_errors_are_told(run, addon, lamina, files, monkeypatch):
    def bake(stack, **_arguments):
        raise AssertionError("this process bakes nothing itself")

    monkeypatch.setattr(lamina, "bake", bake)
    bpy.ops.wm.open_mainfile(filepath=str(files[0]))
    layer = bpy.data.materials["dusty_b"].lamina.layers[0]
    layer.name = "bad"
    real = addon.command_line.worker_pool._command
    script = (
        "import sys; sys.argv = ['', {folder!r}]; sys.path.insert(0, {folder!r}); import lamina; real = lamina.bake\n"
        "def bake(stack, *args, **more):\n"
        "    if stack.layers[0].name == 'bad': raise lamina.SolveError('layers[0].tau: did not converge')\n"
        "    return real(stack, *args, **more)\n"
        "lamina.bake = bake\n"
        "exec(compile(open({script!r}).read(), 'worker', 'exec'))"
    )
    *_, path, folder = real()
    command = [sys.executable, "-c", script.format(folder=folder, script=path)]
    monkeypatch.setattr(addon.command_line.worker_pool, "_command", lambda: command)
    code, lines = run("bake", "--jobs", 2)
    assert code == 1 and lines[0].startswith("dusty_a: fit error")
    assert lines[1] == "dusty_b: failed: Layer 1 “bad”, optical thickness: did not converge"


@pytest.mark.parametrize("always", [False, True])
def test_a_process_that_is_killed_is_replaced_once(run, addon, files, monkeypatch, tmp_path, always):
    """It ends in the middle of its first bake."""
    killed = tmp_path / "killed"
    path, folder = addon.command_line.worker_pool._command()[-2:]
    script = (
        "import os, sys; sys.stdin.readline(); print('out of memory', flush=True)\n"
        f"open({str(killed)!r}, 'a').write('x'); os.kill(os.getpid(), 9)"
    )

    def command():
        is_first = always or not killed.exists()
        return [sys.executable, "-c", script] if is_first else [sys.executable, "-P", path, folder]

    monkeypatch.setattr(addon.command_line.worker_pool, "_command", command)
    code, lines = run("bake", files[0], "dusty_a", "--jobs", 2)
    if always:
        assert code == 1 and len(killed.read_text()) == 2
        assert lines[0].endswith("failed: the process that baked it was ended by signal 9: out of memory")
    else:
        assert code == 0 and ": fit error" in lines[0] and len(killed.read_text()) == 1


def test_no_process_stays_behind_when_the_batch_is_gone(addon, lamina, tmp_path):
    """A worker whose input ends in the middle of a long bake cancels the bake and ends."""
    request = {"stack": lamina.Stack([lamina.Interface(1.5, 0.1), lamina.Medium(albedo=0.9, tau=1.0, varying=True)],
                                     lamina.Lambert(0.5)).to_json(),
               "quality": "final", "basis": "accurate", "threads": 1, "folder": str(tmp_path)}  # fmt: skip
    command = addon.command_line.worker_pool._command()
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    process.stdin.write(json.dumps(request) + "\n")
    process.stdin.flush()
    time.sleep(0.5)
    printed, _ = process.communicate(timeout=120)
    assert process.returncode == 0 and '"kind": "Cancelled"' in printed and list(tmp_path.iterdir()) == []


def test_control_c_ends_a_batch_of_several_processes(files):
    """Finished files stay, the interruption is told, and no lock is left."""
    slow = """
        real = addon.command_line.worker_pool._command
        code = "import sys, time; sys.stdin.readline(); time.sleep(600)"
        addon.command_line.worker_pool._command = lambda: [sys.executable, "-c", code]
        addon.command_line.worker_pool.PATIENCE = 0.1
        addon.command_line.waiting._show = lambda text: text and print("WAITING", flush=True)
    """
    process = in_another_process("bake", *files, "--save", "--jobs", 2, before=slow)
    for line in process.stdout:
        if line.startswith("WAITING"):
            break
    process.send_signal(signal.SIGINT)
    _, error = process.communicate(timeout=120)
    assert process.returncode == 130 and error.strip().endswith("lamina: interrupted: nothing was saved")
    assert sorted(os.listdir(files[0].parent)) == ["one.blend", "two.blend"]
