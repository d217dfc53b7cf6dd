# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust that follows its sliders. Timers do not run in the background, so the tests call the timer's function."""

import threading
import time

import bpy
import numpy as np
import pytest
from addon_helpers import look_until_rest
from dusty_objects import NAME, grid, values


@pytest.fixture
def live(dust, addon, monkeypatch):
    monkeypatch.setattr(addon.settling.live_dust, "REST", 0.0)
    yield addon.settling.live_dust
    addon.settling.live_dust.stop()


@pytest.fixture
def plate(live, addon):
    """A dusty, live plate half below a roof."""
    made, roof = grid(cells=6), grid("Roof", size=0.5, z=0.4)
    roof.location.x = 0.5
    addon.settling.object_dust.settle(bpy.context, made)
    made.lamina_dust.live = True
    assert live.poll() is None, "dust that is up to date stays"
    return made


@pytest.fixture
def settled(addon, monkeypatch):
    """(rays, amount) of all settlings from now on."""
    seen, module = [], addon.settling.object_dust
    real = module.settle_gathered

    def watched(task, *arguments):
        seen.append((task.settling["rays"], task.settling["amount"]))
        return real(task, *arguments)

    monkeypatch.setattr(module, "settle_gathered", watched)
    return seen


def test_a_moved_slider_shows_a_preview_and_then_all_rays(addon, live, plate, settled):
    plate.lamina_dust.amount = 2.0
    assert live.is_pending(plate)
    assert None not in (seen := look_until_rest(live))[:-1] and live.WORKING in seen
    assert settled == [(addon.settling.object_dust.PREVIEW_RAYS, 2.0), (64, 2.0)]
    found = values(plate)
    addon.settling.object_dust.settle(bpy.context, plate)
    assert np.array_equal(found, values(plate)), "the last result is that of Settle Dust"
    assert not live.is_pending(plate) and live.poll() is None


@pytest.mark.parametrize("name, value", [
    ("amount", 0.3), ("spread", 0.1), ("repose", 0.2), ("concavity", 0.9), ("coverage", 0.5), ("wind", 1.0),
    ("form", "mass"), ("seed", 3), ("others", False), ("two_sided", True),
])  # fmt: skip
def test_every_setting_is_followed(addon, live, plate, name, value):
    setattr(plate.lamina_dust, name, value)
    look_until_rest(live)
    settings = plate.lamina_dust
    assert settings.settled == addon.settling.dust_settings.text(settings)
    assert not addon.settling.dust_settings.is_outdated(settings)


def test_a_callback_only_takes_note_and_the_newest_request_wins(addon, live, plate, settled, monkeypatch):
    begun, go = threading.Event(), threading.Event()
    module = addon.settling.object_dust
    real = module.settle_gathered

    def slow(task, *arguments):
        begun.set()
        go.wait(10.0)
        return real(task, *arguments)

    monkeypatch.setattr(module, "settle_gathered", slow)
    plate.lamina_dust.amount = 2.0
    live.poll()
    assert begun.wait(10.0)
    before = values(plate)
    for amount in (3.0, 4.0, 5.0):
        plate.lamina_dust.amount = amount
        assert live.poll() == live.WORKING
    assert np.array_equal(values(plate), before)
    go.set()
    look_until_rest(live)
    assert [amount for _rays, amount in settled] == [2.0, 5.0, 5.0]


def test_a_long_settling_of_old_settings_is_given_up(addon, live, plate, monkeypatch):
    module, lamina = addon.settling.object_dust, addon.base.native.require()
    real = module.settle_gathered

    def endless(task, progress, cancel, threads):
        if task.settling["amount"] == 5.0:
            return real(task, progress, cancel, threads)
        while not cancel():
            time.sleep(0.001)
        raise lamina.Cancelled

    monkeypatch.setattr(module, "settle_gathered", endless)
    monkeypatch.setattr(live, "PATIENCE", 0.0)
    before = values(plate)
    plate.lamina_dust.amount = 2.0
    live.poll()
    assert live.poll() == live.WORKING and np.array_equal(values(plate), before)
    plate.lamina_dust.amount = 5.0
    look_until_rest(live)
    assert values(plate).max() == pytest.approx(5.0, rel=0.05) and live.failure(plate) == ""


def test_the_scene_is_read_once_for_the_previews_and_again_at_rest(addon, live, plate, monkeypatch):
    reads, real = [], addon.settling.geometry.read
    monkeypatch.setattr(addon.settling.geometry, "read", lambda *given: (reads.append(1), real(*given))[1])
    monkeypatch.setattr(live, "REST", 1e9)
    for amount in (2.0, 3.0, 4.0):
        plate.lamina_dust.amount = amount
        while live.poll() == live.WORKING:
            time.sleep(0.001)
    assert len(reads) == 1
    monkeypatch.setattr(live, "REST", 0.0)
    look_until_rest(live)
    assert len(reads) == 2


def test_an_error_is_a_sentence_and_spoils_nothing(addon, live, plate):
    before = values(plate)
    plate.data.vertices[3].co.x = float("nan")
    plate.lamina_dust.amount = 2.0
    look_until_rest(live)
    assert "nan" in live.failure(plate) and "\n" not in live.failure(plate)
    assert np.array_equal(values(plate), before)
    plate.data.vertices[3].co.x = 0.0
    plate.lamina_dust.amount = 2.5
    look_until_rest(live)
    assert live.failure(plate) == "" and values(plate).max() == pytest.approx(2.5, rel=0.05)


def test_over_frames_shows_the_present_one_and_says_so(addon, live, plate, settled):
    settings = plate.lamina_dust
    settings.over_frames, settings.frame_last = True, 100
    look_until_rest(live)
    assert len(settled) == 2 and bpy.context.scene.frame_current == 1
    assert addon.settling.dust_settings.is_outdated(settings)


@pytest.mark.parametrize("way", ["new file", "object removed", "cleared", "settled", "switched off"])
def test_what_ends_a_running_settling(addon, live, plate, way):
    plate.lamina_dust.amount = 2.0
    live.poll()
    if way == "new file":
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    elif way == "object removed":
        bpy.data.objects.remove(plate)
    elif way == "switched off":
        plate.lamina_dust.live = False
    else:
        with bpy.context.temp_override(object=plate):
            operator = bpy.ops.lamina.dust_clear if way == "cleared" else bpy.ops.lamina.dust_settle
            assert operator() == {"FINISHED"}
    look_until_rest(live)
    assert live.running() is None
    if way == "cleared":
        assert NAME not in plate.data.attributes


def test_objects_that_are_not_live_are_left_alone(live, plate):
    other = grid("Other", z=3.0)
    other.lamina_dust.amount = 3.0
    assert live.poll() is None and NAME not in other.data.attributes


def test_after_undo_the_dust_fits_the_settings_again(addon, live, plate):
    plate.lamina_dust["amount"] = 2.5  # as undo does, without a callback
    if plate.lamina_dust.amount != pytest.approx(2.5):
        # Blender 5 keeps the properties of add-ons apart: set, and forget the note
        plate.lamina_dust.amount = 2.5
        live._followed.clear()
    live._on_undo()
    look_until_rest(live)
    assert values(plate).max() == pytest.approx(2.5, rel=0.05)
