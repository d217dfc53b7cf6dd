# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake the layers of a material, and connect the result."""

import bpy

from ..baking import bake_job, update
from ..base import messages
from ..nodes import node_group
from . import common
from .following import Following


class LAMINA_OT_bake(Following, bpy.types.Operator):
    bl_idname = "lamina.bake"
    bl_label = "Update"
    bl_description = "Compute the layers and show them in the nodes of this material. ESC cancels"
    bl_options = {"REGISTER", "UNDO"}

    jobs = bake_job
    kept = "Update cancelled; the earlier one is kept"

    @classmethod
    def poll(cls, context):
        return common.has_stack(cls, context) and common.has_native(cls) and common.is_idle(cls)

    def execute(self, context):
        """Bake and wait for it: scripts, and everything under `blender -b`."""
        material = common.material_of(context)
        update.leave(material)
        try:
            bake_job.bake_material(material)
        except Exception as error:
            return self.failed(error, context)
        return {"FINISHED"}

    def start(self, context):
        material = common.material_of(context)
        update.leave(material)
        return bake_job.start(material, *update.first_settings(material)), f"Lamina bakes {material.name}"

    def ended(self, context, job):
        answer = super().ended(context, job)
        if answer == {"FINISHED"}:
            update.refine(job.material())
        return answer

    def told(self, material):
        report = material.lamina.result.report
        fit = messages.percent(report["fit_error"])
        return f"Baked {material.name} in {report['seconds']:.1f} s, fit error {fit}"

    def failed(self, error, context, job=None):
        material = common.material_of(context) if job is None else job.material()
        if material is None:
            return {"CANCELLED"}
        self.report({"ERROR"}, bake_job.note_failure(material, error))
        index = messages.layer_index(str(error))
        if index is not None and index < len(material.lamina.layers):
            material.lamina.active_index = index
        return {"CANCELLED"}


class LAMINA_OT_connect(bpy.types.Operator):
    bl_idname = "lamina.connect"
    bl_label = "Connect to Output"
    bl_description = "Link the baked node group to the Surface of the material output; other nodes stay"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not common.has_stack(cls, context):
            return False
        if common.material_of(context).lamina.node_group is None:
            cls.poll_message_set("Update first")
            return False
        return True

    def execute(self, context):
        node_group.connect(common.material_of(context))
        return {"FINISHED"}
