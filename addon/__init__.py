# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamina: physically right layered materials for Cycles. The only part of Lamina that imports bpy."""

import bpy

from . import operators
from .baking import bake_job, before_render, lateral_job, update
from .base import image_removal, native, preferences, renders, timers, undo
from .command_line import blend_saving, command
from .editing import match_job
from .interior import interior_job, trial
from .nodes import painted_images
from .properties import dust_properties, material_properties, migration
from .settling import dust_job, live_dust
from .stack_json import solved_colours
from .ui import (
    advanced_panel,
    depth_panel,
    interior_fields,
    menus,
    panel,
    preset_picker,
    result_picture,
    where_panel,
)

PARTS = (
    timers,
    renders,
    undo,
    image_removal,
    material_properties,
    dust_properties,
    solved_colours,
    migration,
    bake_job,
    dust_job,
    lateral_job,
    match_job,
    interior_job,
    trial,
    update,
    before_render,
    painted_images,
    live_dust,
    operators,
    menus,
    preset_picker,
    result_picture,
    panel,
    interior_fields,
    where_panel,
    depth_panel,
    advanced_panel,
    blend_saving,
    command,
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
