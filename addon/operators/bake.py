# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake: blocking in the background, otherwise modal around a worker thread."""

import bpy

from ..baking import bake_job, live
from ..base import messages, native
from . import common
from .following import Following


class LAMINA_OT_bake(Following, bpy.types.Operator):
    bl_idname = "lamina.bake"
    bl_label = "Bake"
    bl_description = "Compute the layers and build the node group of this material. ESC cancels"
    bl_options = {"REGISTER", "UNDO"}

    jobs = bake_job

    @classmethod
    def poll(cls, context):
        return common.has_stack(cls, context) and common.has_native(cls) and common.is_idle(cls)

    def execute(self, context):
        """Bake and wait for it: scripts, and everything under `blender -b`."""
        material = common.material_of(context)
        live.leave(material)
        try:
            bake_job.bake_material(material)
        except Exception as error:
            return self._failed(material, error)
        return {"FINISHED"}

    def invoke(self, context, _event):
        if bpy.app.background:
            return self.execute(context)
        material = common.material_of(context)
        live.leave(material)
        try:
            job = bake_job.start(material)
        except Exception as error:
            return self._failed(material, error)
        return self.follow(context, job, f"Lamina bakes {material.name}")

    def ended(self, _context, job):
        try:
            material = job.finish()
        except native.require().Cancelled:
            material = None
        except Exception as error:
            material = job.material()
            return self._failed(material, error) if material else {"CANCELLED"}
        if material is None:
            self.report({"INFO"}, "Bake cancelled; the earlier one is kept")
            return {"CANCELLED"}
        result = material.lamina.result
        seconds, fit = result.seconds, result.fit_error
        self.report({"INFO"}, f"Baked {material.name} in {seconds:.1f} s, fit error {messages.percent(fit)}")
        return {"FINISHED"}

    def _failed(self, material, error):
        self.report({"ERROR"}, bake_job.note_failure(material, error))
        index = messages.layer_index(str(error))
        if index is not None and index < len(material.lamina.layers):
            material.lamina.active_index = index
        return {"CANCELLED"}
