# SPDX-License-Identifier: GPL-3.0-or-later
"""Timers of the add-on: functions that an operator calls."""

from types import SimpleNamespace

import bpy
import pytest


@pytest.fixture
def timers(addon, monkeypatch):
    """(addon.base.timers as in a window, {function that Blender would call: seconds until the first call})."""
    registered = {}
    shown = SimpleNamespace(
        is_registered=registered.__contains__, unregister=registered.pop,
        register=lambda called, first_interval: registered.update({called: first_interval}))
    window = SimpleNamespace(app=SimpleNamespace(background=False, timers=shown), ops=bpy.ops)
    monkeypatch.setattr(addon.base.timers, "bpy", window)
    monkeypatch.setattr(addon.base.timers, "_called", {})
    return addon.base.timers, registered


def test_a_function_is_called_until_its_end(timers):
    module, registered = timers
    waits = iter([0.5, None])
    module.start(lambda: next(waits), 0.1)
    ((called, first),) = registered.items()
    assert first == 0.1
    assert [called(), called()] == [0.5, None]


def test_one_timer_for_each_function(timers):
    module, registered = timers

    def once():
        return None

    module.start(once)
    module.start(once)
    assert len(registered) == 1
    module.end(once)
    module.end(once)
    assert not registered


def test_an_error_is_told_and_nothing_stays(timers):
    module, registered = timers

    def wrong():
        raise ValueError("seen")

    module.start(wrong)
    (called,) = registered
    with pytest.raises(RuntimeError, match="ValueError: seen"):
        called()
    assert bpy.ops.lamina.timer() == {"CANCELLED"}, "nothing is due"
