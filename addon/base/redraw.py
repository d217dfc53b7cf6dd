# SPDX-License-Identifier: GPL-3.0-or-later
"""Redraws the Properties editors after a change that the user did not make."""

import bpy


def properties():
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "PROPERTIES":
                area.tag_redraw()
