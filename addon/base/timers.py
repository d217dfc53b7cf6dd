# SPDX-License-Identifier: GPL-3.0-or-later
"""Timers: functions that Blender calls after a while, with the right to write to data-blocks.

Blender 4.3 forbids Python to write while it draws, and sometimes does not allow writing again afterwards,
probably when it renders a preview meanwhile (seen). Operators may always write, so an operator calls the
functions."""

import functools

import bpy

_called = {}  # a timer's function: what Blender calls
_due = []  # what the operator calls


class LAMINA_OT_timer(bpy.types.Operator):
    bl_idname = "lamina.timer"
    bl_label = "Continue Lamina's Work"
    bl_description = "For timers of the add-on: updates previews and applies finished work"
    bl_options = {"INTERNAL"}

    def execute(self, _context):
        if not _due:
            return {"CANCELLED"}
        _due.pop()()
        return {"FINISHED"}


def start(function, seconds=0.0):
    """Let Blender call `function` after this time, unless its timer already runs. `function` returns the
    seconds until the next call, or None at the end."""
    called = _called.setdefault(function, functools.partial(_call, function))
    # Nothing runs timers in the background, and one left there at the exit would hang Blender.
    if not bpy.app.background and not bpy.app.timers.is_registered(called):
        bpy.app.timers.register(called, first_interval=seconds)


def end(function):
    """End the timer of `function` if it runs."""
    called = _called.pop(function, None)
    if called is not None and bpy.app.timers.is_registered(called):
        bpy.app.timers.unregister(called)


def register():
    bpy.utils.register_class(LAMINA_OT_timer)


def unregister():
    bpy.utils.unregister_class(LAMINA_OT_timer)


def _call(function):
    wait = None

    def call():
        nonlocal wait
        wait = function()

    _due[:] = [call]
    bpy.ops.lamina.timer()
    return wait
