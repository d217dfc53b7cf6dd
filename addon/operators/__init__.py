# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators, one per file. Each is thin over a plain function that scripts can call."""

import bpy

from .add_stack import LAMINA_OT_add_stack
from .bake import LAMINA_OT_bake
from .bake_cancel import LAMINA_OT_bake_cancel
from .connect import LAMINA_OT_connect
from .layer_add import LAMINA_OT_layer_add
from .layer_duplicate import LAMINA_OT_layer_duplicate
from .layer_move import LAMINA_OT_layer_move
from .layer_remove import LAMINA_OT_layer_remove
from .remove_stack import LAMINA_OT_remove_stack
from .stack_export import LAMINA_OT_stack_export
from .stack_import import LAMINA_OT_stack_import

CLASSES = (
    LAMINA_OT_add_stack,
    LAMINA_OT_remove_stack,
    LAMINA_OT_layer_add,
    LAMINA_OT_layer_remove,
    LAMINA_OT_layer_duplicate,
    LAMINA_OT_layer_move,
    LAMINA_OT_stack_import,
    LAMINA_OT_stack_export,
    LAMINA_OT_bake,
    LAMINA_OT_bake_cancel,
    LAMINA_OT_connect,
)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
