# SPDX-License-Identifier: GPL-3.0-or-later
"""Timers: functions that Blender calls after a while, with the right to write to data-blocks.

Blender 4.3 forbids Python to write while it draws, and sometimes does not allow writing again afterwards,
probably when it renders a preview meanwhile (seen). Operators may write, so an operator calls the
functions. Where Blender refuses the operator too, the update of a window manager's property calls them: the
update may always write, but Blender then draws all windows again. A render of a preview takes the right away
again in rare cases; then Blender calls the function again later. So a function forgets what is due only after
all is written."""

import functools

import bpy

AGAIN = 0.2  # seconds until a function is called again that was not allowed to write
REFUSALS = ("modify blend data in this state", "Writing to ID classes in this context is not allowed")

_called = {}  # a timer's function: what Blender calls
_due = []  # what the operator or the property calls
_errors = []  # of what the property has called


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


def _updated(_manager, _context):
    try:
        _due.pop()()
    except Exception as error:  # Blender would print the error and go on
        _errors.append(error)


def is_refusal(error):
    """True for Blender's error that nothing may be written at present. Later it may."""
    is_of_blender = isinstance(error, (RuntimeError, AttributeError))
    return is_of_blender and any(words in str(error) for words in REFUSALS)


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
    bpy.types.WindowManager.lamina_timer = bpy.props.BoolProperty(
        options={"HIDDEN", "SKIP_SAVE"}, update=_updated
    )


def unregister():
    del bpy.types.WindowManager.lamina_timer
    bpy.utils.unregister_class(LAMINA_OT_timer)


def _call(function):
    wait = None

    def call():
        nonlocal wait
        wait = function()

    try:
        with_right_to_write(call)
    except (RuntimeError, AttributeError) as error:
        if not is_refusal(error):
            raise
        return AGAIN
    return wait


def with_right_to_write(function):
    """Call a function of no arguments by the operator, or by the property where Blender refuses the operator.

    Raises the function's errors: by the operator as RuntimeError, by the property as they are."""
    _due[:] = [function]
    try:
        bpy.ops.lamina.timer()
    except RuntimeError as error:
        if not _due or not is_refusal(error):
            raise
        bpy.context.window_manager.lamina_timer = True
        if _errors:
            raise _errors.pop() from None
