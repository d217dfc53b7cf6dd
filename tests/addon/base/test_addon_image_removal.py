# SPDX-License-Identifier: GPL-3.0-or-later
"""Images that a render may still read are removed later."""

from types import SimpleNamespace

import bpy
import pytest


@pytest.fixture
def removal(addon, monkeypatch):
    """The module as in a window, with `now` (seconds) and `job` (the running job or None) set by the test."""
    module, state = addon.base.image_removal, SimpleNamespace(now=100.0, job=None)
    app = SimpleNamespace(background=False, is_job_running=lambda job: job == state.job)
    monkeypatch.setattr(module, "bpy", SimpleNamespace(app=app, data=bpy.data))
    monkeypatch.setattr(module, "time", SimpleNamespace(monotonic=lambda: state.now))
    monkeypatch.setattr(module.renders, "is_running", lambda: state.job == "RENDER")
    monkeypatch.setattr(module.timers, "start", lambda *_: None)
    yield SimpleNamespace(module=module, state=state)
    module._unused.clear()


@pytest.fixture
def image():
    return bpy.data.images.new("Table", 2, 2)


def names():
    return {one.name for one in bpy.data.images}


def test_an_image_stays_a_second_and_leaves_its_name(removal, image):
    removal.module.remove(image)
    other = bpy.data.images.new("Table", 2, 2)
    assert other.name == "Table" and removal.module.poll() is not None
    removal.state.now += 1.5
    assert names() >= {"Table", "Table (unused)"} and removal.module.poll() is None
    assert "Table" in names() and "Table (unused)" not in names()


@pytest.mark.parametrize("job", ["RENDER_PREVIEW", "RENDER"])
def test_a_render_keeps_an_image_for_a_limited_time(removal, image, job):
    removal.module.remove(image)
    removal.state.job = job
    removal.state.now += 20.0
    assert removal.module.poll() is not None and "Table (unused)" in names()
    removal.state.now += 20.0
    assert removal.module.poll() is None and "Table (unused)" not in names()


def test_an_image_that_is_used_again_stays(removal, image):
    removal.module.remove(image)
    image.use_fake_user = True
    removal.state.now += 1.5
    assert removal.module.poll() is None and image.name in names()


def test_a_replaced_image_gives_name_and_users(removal, image):
    texture = bpy.data.textures.new("User", "IMAGE")
    texture.image = image
    new = bpy.data.images.new("New", 2, 2)
    removal.module.replace(image, new)
    assert texture.image == new and new.name == "Table" and image.users == 0
    removal.state.now += 1.5
    removal.module.poll()
    assert "Table (unused)" not in names() and new.name == "Table"


def test_undo_takes_a_used_image_off_the_list(removal, image):
    """An image that was removed with its users, and that undo has given back, stays under its old name."""
    texture = bpy.data.textures.new("User", "IMAGE")
    texture.image = image
    removal.module.remove(image)
    removal.module._on_undo()
    removal.state.now += 1.5
    assert removal.module.poll() is None and "Table" in names() and "Table (unused)" not in names()
