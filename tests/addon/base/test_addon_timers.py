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


def test_a_function_that_may_not_write_is_called_again(timers):
    """Blender 4.3 refuses writes in rare moments, and drops a timer that raises."""
    module, registered = timers
    answers = iter([RuntimeError("can't modify blend data in this state (drawing/rendering)"), None])

    def sometimes():
        answer = next(answers)
        if answer is not None:
            raise answer

    module.start(sometimes)
    (called,) = registered
    assert [called(), called()] == [module.AGAIN, None]


@pytest.fixture
def refusing(timers, monkeypatch):
    """(addon.base.timers, its functions) while Blender refuses operators: in 4.3, after a preview, for the rest of the
    session."""
    module, registered = timers

    def refused():
        raise RuntimeError('Calling operator "bpy.ops.lamina.timer" error, cannot modify blend data in this state '
                           "(drawing/rendering)")  # the words of 5.2; 4.3 says "can't"

    monkeypatch.setattr(module.bpy, "ops", SimpleNamespace(lamina=SimpleNamespace(timer=refused)))
    monkeypatch.setattr(module.bpy, "context", bpy.context, raising=False)
    return module, registered


def test_a_property_calls_the_function_where_the_operator_is_refused(refusing):
    module, registered = refusing
    waits = iter([0.5, None])
    module.start(lambda: next(waits))
    (called,) = registered
    assert [called(), called()] == [0.5, None]


def test_errors_are_told_where_the_operator_is_refused(refusing):
    module, registered = refusing

    def wrong():
        raise ValueError("seen")

    module.start(wrong)
    (called,) = registered
    with pytest.raises(ValueError, match="seen"):
        called()
    answers = iter([AttributeError("Writing to ID classes in this context is not allowed: Cube"), None])

    def sometimes():
        answer = next(answers)
        if answer is not None:
            raise answer

    module.start(sometimes)
    called = list(registered)[-1]
    assert [called(), called()] == [module.AGAIN, None]
