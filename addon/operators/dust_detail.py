# SPDX-License-Identifier: GPL-3.0-or-later
"""Add grain and clouds to the varying layer's thickness, or remove them."""

import bpy

from ..base.messages import RefusedError
from ..nodes import detail_wiring
from ..settling import object_dust
from . import common


class LAMINA_OT_dust_detail(bpy.types.Operator):
    bl_idname = "lamina.dust_detail"
    bl_label = "Grain and Clouds"
    bl_description = "Vary the thickness by noise, in sizes that fit the active object; the mean stays"
    bl_options = {"REGISTER", "UNDO"}

    remove: bpy.props.BoolProperty(
        name="Remove", description="Remove the noise and the painted mask", options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context):
        return common.has_thickness(cls, context)

    def execute(self, context):
        material, thing = common.material_of(context), context.object
        if self.remove:
            detail_wiring.remove_detail(material)
            return {"FINISHED"}
        try:
            detail_wiring.add_detail(material, object_dust.largest_side(thing) if thing is not None else 0.0)
        except RefusedError as error:
            return common.refused(self, error)
        return {"FINISHED"}
