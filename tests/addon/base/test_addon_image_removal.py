# SPDX-License-Identifier: GPL-3.0-or-later
"""Images that a render may still read are removed later."""

from types import SimpleNamespace

import bpy
import pytest


@pytest.fixture
def removal(addon, monkeypatch):
    """The module as in a window, with `job` (the running job or None) set by the test. look(count): that many calls of
    the timer; returns what the last one returned."""
    module, state = addon.base.image_removal, SimpleNamespace(job=None)
    app = SimpleNamespace(background=False, is_job_running=lambda job: job == state.job)
    monkeypatch.setattr(module, "bpy", SimpleNamespace(app=app, data=bpy.data))
    monkeypatch.setattr(module.renders, "is_running", lambda: state.job == "RENDER")
    monkeypatch.setattr(module.timers, "start", lambda *_: None)
    yield SimpleNamespace(module=module, state=state, look=lambda count: [module.poll() for _ in range(count)][-1])
    module._unused.clear()


@pytest.fixture
def image():
    return bpy.data.images.new("Table", 2, 2)


def names():
    return {one.name for one in bpy.data.images}


def test_an_image_stays_for_some_looks_and_leaves_its_name(removal, image):
    removal.module.remove(image)
    other = bpy.data.images.new("Table", 2, 2)
    assert other.name == "Table" and removal.look(removal.module.LOOKS) is not None
    assert names() >= {"Table", "Table (unused)"} and removal.look(1) is None
    assert "Table" in names() and "Table (unused)" not in names()


@pytest.mark.parametrize("job", ["RENDER_PREVIEW", "RENDER"])
def test_a_render_keeps_an_image_to_its_end(removal, image, job):
    removal.module.remove(image)
    removal.state.job = job
    assert removal.look(10 * removal.module.LOOKS) is not None and "Table (unused)" in names()
    removal.state.job = None
    assert removal.look(1) is None and "Table (unused)" not in names()


def test_an_image_that_is_used_again_stays(removal, image):
    removal.module.remove(image)
    image.use_fake_user = True
    assert removal.look(removal.module.LOOKS + 1) is None and image.name in names()


def test_a_replaced_image_gives_name_and_users(removal, image):
    texture = bpy.data.textures.new("User", "IMAGE")
    texture.image = image
    new = bpy.data.images.new("New", 2, 2)
    removal.module.replace(image, new)
    assert texture.image == new and new.name == "Table" and image.users == 0
    removal.look(removal.module.LOOKS + 1)
    assert "Table (unused)" not in names() and new.name == "Table"


def test_undo_takes_a_used_image_off_the_list(removal, image):
    """An image that was removed with its users, and that undo has given back, stays under its old name."""
    texture = bpy.data.textures.new("User", "IMAGE")
    texture.image = image
    removal.module.remove(image)
    removal.module._on_undo()
    assert image.name == "Table (unused)", "Blender 4.3 may not allow a handler to write"
    assert removal.look(1) is None and image.name == "Table"


@pytest.mark.parametrize("name", ["Table " + 57 * "x", 21 * "漆"])
def test_a_long_name(removal, image, name):
    """Of 63 bytes before Blender 5.0: there is no room behind it."""
    image.name = name
    name, texture = image.name, bpy.data.textures.new("User", "IMAGE")
    removal.module.remove(image)
    other = bpy.data.images.new(name, 2, 2)
    assert other.name == name and image.name.endswith(" (unused)")
    bpy.data.images.remove(other)
    texture.image = image
    removal.module._on_undo()
    assert removal.look(1) is None and image.name == name


def test_an_image_that_redo_takes_away_again_is_removed(removal, image):
    texture = bpy.data.textures.new("User", "IMAGE")
    removal.module.remove(image)
    texture.image = image
    removal.module._on_undo()
    texture.image = None
    removal.module._on_undo()
    assert removal.look(removal.module.LOOKS + 1) is None and "Table (unused)" not in names()
