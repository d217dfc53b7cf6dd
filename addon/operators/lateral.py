# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that travels sideways below a surface."""

import bpy

from ..baking import lateral_job, volume_bounces
from ..base.messages import RefusedError
from ..interior import trial
from ..properties.material_properties import AUTOMATIC
from ..scene import soft
from . import common
from .making import Making, MakingOnObject


class LAMINA_OT_lateral(Making, bpy.types.Operator):
    bl_idname = "lamina.lateral"
    bl_label = "Let Light Travel Sideways"
    bl_description = "Build nodes whose light enters at one place and leaves at another. ESC cancels"
    bl_options = {"REGISTER", "UNDO"}

    jobs = lateral_job
    changes_engine = True  # for a trial
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
        if material.lamina.lateral == AUTOMATIC:
            soft.make(context, _object(context, material), material)
        else:
            lateral_job.make(material, context.scene)

    def started(self, context, material):
        if material.lamina.lateral == AUTOMATIC:
            return soft.start(context, _object(context, material), material)
        return lateral_job.start(material, context.scene)

    def told(self, material):
        return material.lamina.lateral_report


class LAMINA_OT_trial(MakingOnObject, bpy.types.Operator):
    bl_idname = "lamina.trial"
    bl_label = "Try on This Object"
    bl_description = (
        "Compare what the material shows on the active object with walks through the object, under the "
        "present lamps, at places that the camera sees"
    )
    bl_options = {"REGISTER", "UNDO"}

    jobs = trial
    status = "Lamina tries the light of"
    busy = "A trial is running"

    def told(self, material):
        return material.lamina.trial


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


def _object(context, material):
    """The active object, on which outputs are tried. Raises RefusedError."""
    obj = context.object
    if obj is None or not any(slot.material == material for slot in obj.material_slots):
        what = f"select an object with {material.name}"
        raise RefusedError(f"{what}: Automatic tries the light on the active object")
    return obj
