# SPDX-License-Identifier: GPL-3.0-or-later
"""Has the Properties editors drawn again: something they show has changed without the user's doing."""

import bpy


def properties():
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "PROPERTIES":
                area.tag_redraw()
