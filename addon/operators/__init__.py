# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators, by subject. Each calls a plain function that scripts can call too."""

import bpy

from . import (
    bake,
    cancel,
    depth,
    dust,
    following,
    interior,
    lateral,
    layers,
    measurements,
    place,
    presets,
    sparkle,
    stack,
    stack_files,
)

CLASSES = (
    stack.LAMINA_OT_add_over,
    stack.LAMINA_OT_add_stack,
    stack.LAMINA_OT_read_again,
    stack.LAMINA_OT_remove_stack,
    layers.LAMINA_OT_layer_add,
    layers.LAMINA_OT_layer_remove,
    layers.LAMINA_OT_layer_duplicate,
    layers.LAMINA_OT_layer_move,
    layers.LAMINA_OT_sheet_close,
    layers.LAMINA_OT_phase_replace,
    layers.LAMINA_OT_coats_replace,
    layers.LAMINA_OT_profile_replace,
    layers.LAMINA_OT_match_colors,
    layers.LAMINA_OT_metal,
    measurements.LAMINA_OT_measured_base,
    measurements.LAMINA_OT_match_measurement,
    presets.LAMINA_OT_preset_apply,
    presets.LAMINA_OT_preset_save,
    presets.LAMINA_OT_preset_delete,
    stack_files.LAMINA_OT_stack_import,
    stack_files.LAMINA_OT_stack_export,
    bake.LAMINA_OT_bake,
    bake.LAMINA_OT_connect,
    lateral.LAMINA_OT_lateral,
    lateral.LAMINA_OT_lateral_bounces,
    lateral.LAMINA_OT_trial,
    interior.LAMINA_OT_interior,
    interior.LAMINA_OT_interior_copy,
    interior.LAMINA_OT_end_preset,
    dust.LAMINA_OT_dust_settle,
    dust.LAMINA_OT_dust_image,
    dust.LAMINA_OT_dust_clear,
    dust.LAMINA_OT_dust_objects,
    dust.LAMINA_OT_dust_objects_remove,
    place.LAMINA_OT_place,
    place.LAMINA_OT_dust_detail,
    place.LAMINA_OT_displace,
    place.LAMINA_OT_dust_wipe,
    place.LAMINA_OT_stamp,
    place.LAMINA_OT_film_paint,
    depth.LAMINA_OT_depth,
    sparkle.LAMINA_OT_sparkle,
    cancel.LAMINA_OT_cancel,
)

register, _unregister_classes = bpy.utils.register_classes_factory(CLASSES)


def unregister():
    following.stop()
    _unregister_classes()
