# SPDX-License-Identifier: GPL-3.0-or-later
"""Raise the scene's bounces to what the portal needs."""

import bpy

from ..baking import volume_bounces
from . import common


class LAMINA_OT_lateral_bounces(bpy.types.Operator):
    bl_idname = "lamina.lateral_bounces"
    bl_label = "Raise Bounces"
    bl_description = "Raise the scene's volume and total bounces to what the portal of this material needs"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return common.has_stack(cls, context)

    def execute(self, context):
        told = volume_bounces.provide(context.scene, common.material_of(context))
        self.report({"INFO"}, told or "The scene has enough bounces")
        return {"FINISHED"}
