# SPDX-License-Identifier: GPL-3.0-or-later
"""Light inside an object."""

import bpy

from ..base import native
from ..interior import contents, interior_job
from . import common
from .making import MakingOnObject


class LAMINA_OT_interior(MakingOnObject, bpy.types.Operator):
    bl_idname = "lamina.interior"
    bl_label = "Compute Interior"
    bl_description = (
        "Follow light inside the active object and show it by images, coarse ones first. ESC stops: the "
        "images so far stay (Undo restores the earlier nodes), and the next start continues"
    )
    bl_options = {"REGISTER", "UNDO"}

    jobs = interior_job
    status = "Lamina follows light inside"
    busy = "An interior is being computed"

    def told(self, material):
        return material.lamina.interior.report


class LAMINA_OT_interior_copy(bpy.types.Operator):
    bl_idname = "lamina.interior_copy"
    bl_label = "Own Copy of the Material"
    bl_description = "Give the active object a copy of the material. Objects that share a mesh still share it"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return common.can_edit(cls, context) and context.object is not None and context.object.is_editable

    def execute(self, context):
        interior_job.own_copy(context.object, common.material_of(context))
        return {"FINISHED"}


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
