# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions that Blender calls at events such as the load of a file."""

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
