# SPDX-License-Identifier: GPL-3.0-or-later
"""One Blender for all add-on tests: its own user folder, the add-on enabled from this clone.

Blender reads its user folder when bpy is imported, so it is set before. bpy may hang when the interpreter exits, so the
process ends by os._exit after pytest's report.
"""

import atexit
import os
import shutil
import sys
import tempfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
MODULE = "bl_ext.user_default.lamina"

sys.dont_write_bytecode = True

if "bpy" in sys.modules:
    RESOURCES = Path(os.environ.get("BLENDER_USER_RESOURCES") or tempfile.mkdtemp(prefix="lamina-blender-"))
else:
    RESOURCES = Path(tempfile.mkdtemp(prefix="lamina-blender-"))
    os.environ["BLENDER_USER_RESOURCES"] = str(RESOURCES)
    (RESOURCES / "extensions" / "user_default").mkdir(parents=True)
    (RESOURCES / "extensions" / "user_default" / "lamina").symlink_to(
        ROOT / "addon", target_is_directory=True
    )

import bpy  # noqa: E402, I001 (its scripts hold addon_utils)
import addon_utils  # noqa: E402

_exit_status = [0]


def pytest_sessionstart(session):
    enable()


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(session, exitstatus):
    _exit_status[0] = int(exitstatus)


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config):
    disable()
    _remove_resources()
    if not hasattr(config, "workerinput"):
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(_exit_status[0])


@atexit.register
def _remove_resources():
    if RESOURCES.name.startswith("lamina-blender-"):
        shutil.rmtree(RESOURCES, ignore_errors=True)


def enable():
    """Enable the add-on of this clone; its package."""
    package = addon_utils.enable(MODULE, default_set=True)
    assert package is not None, "the add-on could not be enabled"
    return package


def disable():
    addon_utils.disable(MODULE, default_set=True)


@pytest.fixture(autouse=True)
def finished_bakes(tmp_path_factory, monkeypatch):
    """The folder of a batch's finished bakes, a new one for each test."""
    folder = tmp_path_factory.mktemp("finished")
    monkeypatch.setenv("LAMINA_CACHE", str(folder))
    return folder


@pytest.fixture
def addon():
    """The add-on's package, enabled, in an empty file."""
    package = enable()
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    yield package
    for material in list(bpy.data.materials):
        bpy.data.materials.remove(material)


@pytest.fixture
def lamina(addon):
    """The native package; tests that bake are skipped without it."""
    if not addon.base.native.available():
        pytest.skip(addon.base.native.reason())
    return addon.base.native.require()


@pytest.fixture
def material(addon):
    """A new material with nodes and a first stack: one layer of dust over grey, preview quality."""
    material = bpy.data.materials.new("Bronze")
    addon.nodes.node_tree.of(material)
    addon.editing.layer_list.add_stack(material)
    material.lamina.quality = "preview"
    return material


@pytest.fixture
def disabled_afterwards():
    """The add-on may be disabled in the test; the next one finds it enabled."""
    yield
    enable()


@pytest.fixture
def call():
    """call(operator, material, **properties): an operator as the panel calls it."""

    def call(operator, material, **properties):
        with bpy.context.temp_override(material=material):
            return operator(**properties)

    return call
