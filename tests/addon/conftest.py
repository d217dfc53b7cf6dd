# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures for all add-on tests: the add-on in an empty file, the native package, a material.

bpy may hang when the interpreter exits, so the process ends by os._exit after pytest's report.
"""

import os
import sys

import own_blender  # isort: skip (before bpy)
import bpy
import pytest

_exit_status = [0]


def pytest_sessionstart(session):
    own_blender.enable()


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(session, exitstatus):
    _exit_status[0] = int(exitstatus)


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config):
    own_blender.disable()
    own_blender.remove_resources()
    if not hasattr(config, "workerinput"):
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(_exit_status[0])


@pytest.fixture(autouse=True)
def finished_bakes(tmp_path_factory, monkeypatch):
    """The folder of a batch's finished bakes, a new one for each test."""
    folder = tmp_path_factory.mktemp("finished")
    monkeypatch.setenv("LAMINA_CACHE", str(folder))
    return folder


@pytest.fixture
def addon():
    """The add-on's package, enabled, in an empty file."""
    package = own_blender.enable()
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


@pytest.fixture(scope="module")
def known_tables():
    """The tables of `equal_bakes_once`; a test that clears them bakes itself."""
    return {}


@pytest.fixture
def equal_bakes_once(lamina, known_tables, monkeypatch):
    """The tests of a module share the tables of equal bakes."""
    bake = lamina.bake

    def once(stack, quality="final", progress=None, cancel=None, threads=0, **how):
        key = stack.hash, quality, repr(sorted(how.items()))
        if key not in known_tables:
            known_tables[key] = bake(stack, quality, progress=progress, cancel=cancel, threads=threads, **how)
        return known_tables[key]

    monkeypatch.setattr(lamina, "bake", once)


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
    own_blender.enable()


@pytest.fixture
def call():
    """call(operator, material, **properties): an operator as the panel calls it."""

    def call(operator, material, **properties):
        with bpy.context.temp_override(material=material):
            return operator(**properties)

    return call
