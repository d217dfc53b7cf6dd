# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions that Blender calls: handlers of events such as the load of a file, and timers."""

import bpy


def add(handlers):
    """Add handlers: {name of a list in bpy.app.handlers: function}. To stay after the load of another file, a
    function must be @persistent."""
    for name, handler in handlers.items():
        getattr(bpy.app.handlers, name).append(handler)


def remove(handlers):
    """Remove handlers, as for `add`, where they are present."""
    for name, handler in handlers.items():
        present = getattr(bpy.app.handlers, name)
        if handler in present:
            present.remove(handler)


def start_timer(function, seconds=0.0):
    """Let Blender call a timer's function after this time, unless the timer already runs."""
    # Nothing runs timers in the background, and one left there at the exit would hang Blender.
    if not bpy.app.background and not bpy.app.timers.is_registered(function):
        bpy.app.timers.register(function, first_interval=seconds)


def end_timer(function):
    """End a timer if it runs."""
    if bpy.app.timers.is_registered(function):
        bpy.app.timers.unregister(function)
