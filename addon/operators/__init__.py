# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators, one per file. Each calls a plain function that scripts can call too."""

import bpy

from . import following
from .add_over import LAMINA_OT_add_over
from .add_stack import LAMINA_OT_add_stack
from .bake import LAMINA_OT_bake
from .bake_cancel import LAMINA_OT_bake_cancel
from .connect import LAMINA_OT_connect
from .dust_cancel import LAMINA_OT_dust_cancel
from .dust_clear import LAMINA_OT_dust_clear
from .dust_detail import LAMINA_OT_dust_detail
from .dust_settle import LAMINA_OT_dust_settle
from .dust_wipe import LAMINA_OT_dust_wipe
from .end_preset import LAMINA_OT_end_preset
from .interior import LAMINA_OT_interior
from .interior_cancel import LAMINA_OT_interior_cancel
from .lateral import LAMINA_OT_lateral
from .lateral_bounces import LAMINA_OT_lateral_bounces
from .lateral_cancel import LAMINA_OT_lateral_cancel
from .layer_add import LAMINA_OT_layer_add
from .layer_duplicate import LAMINA_OT_layer_duplicate
from .layer_move import LAMINA_OT_layer_move
from .layer_remove import LAMINA_OT_layer_remove
from .metal import LAMINA_OT_metal
from .phase_replace import LAMINA_OT_phase_replace
from .preset_apply import LAMINA_OT_preset_apply
from .preset_delete import LAMINA_OT_preset_delete
from .preset_save import LAMINA_OT_preset_save
from .profile_replace import LAMINA_OT_profile_replace
from .remove_stack import LAMINA_OT_remove_stack
from .sheet_close import LAMINA_OT_sheet_close
from .stack_export import LAMINA_OT_stack_export
from .stack_import import LAMINA_OT_stack_import
from .thickness_wire import LAMINA_OT_thickness_wire

CLASSES = (
    LAMINA_OT_add_over,
    LAMINA_OT_add_stack,
    LAMINA_OT_remove_stack,
    LAMINA_OT_layer_add,
    LAMINA_OT_layer_remove,
    LAMINA_OT_layer_duplicate,
    LAMINA_OT_layer_move,
    LAMINA_OT_sheet_close,
    LAMINA_OT_phase_replace,
    LAMINA_OT_profile_replace,
    LAMINA_OT_metal,
    LAMINA_OT_preset_apply,
    LAMINA_OT_preset_save,
    LAMINA_OT_preset_delete,
    LAMINA_OT_stack_import,
    LAMINA_OT_stack_export,
    LAMINA_OT_bake,
    LAMINA_OT_bake_cancel,
    LAMINA_OT_connect,
    LAMINA_OT_lateral,
    LAMINA_OT_lateral_bounces,
    LAMINA_OT_lateral_cancel,
    LAMINA_OT_interior,
    LAMINA_OT_interior_cancel,
    LAMINA_OT_end_preset,
    LAMINA_OT_dust_settle,
    LAMINA_OT_dust_cancel,
    LAMINA_OT_dust_clear,
    LAMINA_OT_dust_detail,
    LAMINA_OT_dust_wipe,
    LAMINA_OT_thickness_wire,
)

register, _unregister_classes = bpy.utils.register_classes_factory(CLASSES)


def unregister():
    following.stop()
    _unregister_classes()
