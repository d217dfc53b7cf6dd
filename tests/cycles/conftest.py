# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on of this clone, for the tests that bake as a user does, and fixtures that several tests share."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import baked_samples
import bpy
import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def addon(tmp_path_factory):
    """Enabled from an extension repository of our own."""
    import addon_utils  # findable once bpy is there

    running = sys.modules.get("bl_ext.user_default.lamina")
    if getattr(running, "__addon_enabled__", False):
        yield running
        return
    folder = tmp_path_factory.mktemp("extensions")
    shutil.copytree(ROOT / "addon", folder / "lamina", ignore=shutil.ignore_patterns("__pycache__"))
    repositories = bpy.context.preferences.extensions.repos
    repository = repositories.new(name="Goniophotometer", module="gonio", custom_directory=str(folder))
    package = addon_utils.enable("bl_ext.gonio.lamina", default_set=True)
    assert package is not None and package.base.native.available(), package and package.base.native.reason()
    yield package
    addon_utils.disable("bl_ext.gonio.lamina", default_set=True)
    if hasattr(bpy.types.Material, "lamina"):  # a class left at interpreter exit hangs Blender
        package.unregister()
    repositories.remove(repository)


@pytest.fixture
def demo(tmp_path):
    """demo(name) -> (its JSON, what it prints): a demo at the tiny quality, whose files are in tmp_path."""

    def demo(name):
        if not list((ROOT / "build/extension").glob("lamina-[0-9]*.zip")):
            pytest.skip("build/extension/ holds no extension: run `make build/stamps/extension`")
        command = [sys.executable, ROOT / "demo_scenes/make_demo.py", name, "--quality", "tiny", "--out", tmp_path]
        done = subprocess.run(command, capture_output=True, text=True, timeout=600)
        assert done.returncode == 0, done.stdout + done.stderr
        return json.loads((tmp_path / f"{name}.json").read_text()), done.stdout

    return demo


@pytest.fixture(scope="module")
def furnace(samples):
    """The readings of the module's samples in a white furnace."""
    return baked_samples.in_the_furnace(samples)
