# SPDX-License-Identifier: GPL-3.0-or-later
"""Operator for lateral light transport."""

import bpy

from ..baking import lateral_job
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
