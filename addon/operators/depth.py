# SPDX-License-Identifier: GPL-3.0-or-later
"""How light below the surface is shown."""

import bpy

from ..editing import depth
from ..interior import motion
from ..properties.material_properties import DEPTHS
from . import common


class LAMINA_OT_depth(bpy.types.Operator):
    bl_idname = "lamina.depth"
    bl_label = "Depth"
    bl_description = "Choose how light below the surface is shown"
    bl_options = {"REGISTER", "UNDO"}

    depth: bpy.props.EnumProperty(
        name="Depth", description="How light below the surface is shown", items=DEPTHS, options={"SKIP_SAVE"}
    )

    @classmethod
    def description(cls, _context, properties):
        return next(text for item, _name, text in DEPTHS if item == properties.depth)

    @classmethod
    def poll(cls, context):
        return common.has_stack(cls, context)

    def execute(self, context):
        obj = context.object
        lamps_move = obj is not None and obj.type == "MESH" and bool(motion.moving_lamps(context, obj))
        depth.choose(common.material_of(context), self.depth, lamps_move)
        return {"FINISHED"}
