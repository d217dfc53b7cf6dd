# SPDX-License-Identifier: GPL-3.0-or-later
"""Fill an end material of an interior from the library."""

import bpy

from ..base import native
from ..interior import contents
from . import common


class LAMINA_OT_end_preset(bpy.types.Operator):
    bl_idname = "lamina.end_preset"
    bl_label = "Choose Material"
    bl_description = "Take the coefficients per mm of a preset of the library"
    bl_options = {"REGISTER", "UNDO"}

    preset: bpy.props.StringProperty(name="Preset", description="Id of the preset")
    second: bpy.props.BoolProperty(name="Veins", description="The second of the two materials")

    @classmethod
    def poll(cls, context):
        return common.can_edit(cls, context) and common.has_native(cls)

    def execute(self, context):
        interior = common.material_of(context).lamina.interior
        try:
            contents.fill(interior.second if self.second else interior.first, self.preset)
        except (ValueError, native.NativeMissingError) as error:
            return common.refused(self, error)
        return {"FINISHED"}
