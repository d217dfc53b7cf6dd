# SPDX-License-Identifier: GPL-3.0-or-later
"""Flamenco's job type: compiled in Node with a stand-in for the Manager, its commands read by the batch's own words."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
NODE = shutil.which("node")
SETTINGS = {"blendfile": "/shots/a b.blend", "more_files": "", "quality": "final", "materials": "", "threads": 0,
            "force": False}

pytestmark = pytest.mark.skipif(NODE is None, reason="Node is not installed: Flamenco's job type cannot be compiled")


def compiled(**settings):
    given = json.dumps({**SETTINGS, **settings})
    return subprocess.run([NODE, Path(__file__).with_name("flamenco_stub.js"), ROOT / "farm/flamenco/lamina_bake.js",
                           given], capture_output=True, text=True, timeout=60)


def tasks(**settings):
    ran = compiled(**settings)
    assert ran.returncode == 0, ran.stderr
    return json.loads(ran.stdout)["tasks"]


def command_line(task):
    """What the worker runs."""
    (command,) = task["commands"]
    assert command["name"] == "blender-render"
    given = command["parameters"]
    assert (given["exe"], given["exeArgs"]) == ("{blender}", "{blenderArgs}")
    return [*given["argsBefore"], given["blendfile"], *given["args"]]


def test_one_file():
    (task,) = tasks()
    assert task["type"] == "blender" and task["name"] == "bake-a b.blend"
    assert command_line(task) == ["--background", "/shots/a b.blend", "--python-exit-code", "1", "--command", "lamina",
                                  "bake", "--quality", "final", "--threads", "0", "--save"]


def test_a_task_for_each_file_once():
    found = tasks(more_files=" /shots/b.blend; /shots/c.blend;;/shots/b.blend ;/shots/a b.blend", quality="preview")
    assert [command_line(task)[1] for task in found] == ["/shots/a b.blend", "/shots/b.blend", "/shots/c.blend"]
    assert all(command_line(task)[-5:] == ["--quality", "preview", "--threads", "0", "--save"] for task in found)
    assert all(not task["dependencies"] for task in found)


def test_materials_threads_and_force():
    line = command_line(tasks(materials="Wall; -odd name ;floor_*", threads=4, force=True)[0])
    assert line[7:] == ["--quality", "final", "--threads", "4", "--force", "--materials=Wall", "--materials=-odd name",
                        "--materials=floor_*", "--save"]


@pytest.mark.parametrize(("settings", "sentence"), [
    ({"quality": "best"}, "quality = best: must be final or preview"),
    ({"threads": -1}, "threads = -1: must be a whole number from 0 (all) to 1024"),
    ({"threads": 1.5}, "threads = 1.5: must be a whole number from 0 (all) to 1024"),
])
def test_bad_settings_get_a_sentence(settings, sentence):
    ran = compiled(**settings)
    assert ran.returncode == 1 and ran.stderr.strip() == sentence and not ran.stdout


def test_settings_are_described():
    settings = json.loads(compiled().stdout)["type"]["settings"]
    assert {one["key"] for one in settings} == set(SETTINGS)
    assert all(one["description"] and one["type"] in ("string", "int32", "bool", "float") for one in settings)
