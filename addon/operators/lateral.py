# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that travels sideways below a surface."""

import bpy

from ..baking import lateral_job, volume_bounces
from . import common
from .making import Making


class LAMINA_OT_lateral(Making, bpy.types.Operator):
    bl_idname = "lamina.lateral"
    bl_label = "Let Light Travel Sideways"
    bl_description = "Build nodes whose light enters at one place and leaves at another. ESC cancels"
    bl_options = {"REGISTER", "UNDO"}

    jobs = lateral_job
    status = "Lamina follows light below"

    @classmethod
    def poll(cls, context):
        if not common.has_stack(cls, context) or not common.has_native(cls):
            return False
        if lateral_job.running() is not None:
            cls.poll_message_set("Light that travels sideways is being computed")
            return False
        return True

    def made(self, context, material):
        lateral_job.make(material, context.scene)

    def started(self, context, material):
        return lateral_job.start(material, context.scene)

    def told(self, material):
        return material.lamina.lateral_report


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
