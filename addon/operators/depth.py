# SPDX-License-Identifier: GPL-3.0-or-later
"""How light below the surface is shown."""

import bpy

from ..editing import depth
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
        depth.choose(common.material_of(context), self.depth)
        return {"FINISHED"}
