# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamina: physically right layered materials for Cycles. The only part of Lamina that knows Blender."""

import bpy

from . import (
    bake_job,
    blend_saving,
    command_line,
    dust_job,
    dust_panel,
    dust_properties,
    live,
    menus,
    migration,
    native,
    operators,
    panel,
    preferences,
    properties,
    shown,
    thickness_panel,
)

PARTS = (
    properties,
    dust_properties,
    shown,
    migration,
    bake_job,
    dust_job,
    live,
    operators,
    menus,
    panel,
    thickness_panel,
    dust_panel,
    blend_saving,
    command_line,
)


def register():
    native.load()
    bpy.utils.register_class(preferences.LaminaPreferences)
    for part in PARTS:
        part.register()


def unregister():
    for part in reversed(PARTS):
        part.unregister()
    bpy.utils.unregister_class(preferences.LaminaPreferences)
