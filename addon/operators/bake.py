# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake: blocking in the background, otherwise modal around a worker thread."""

import bpy

from .. import bake_job, live, messages, native, redraw
from . import common

INTERVAL = 0.1  # seconds between two looks at the worker


class LAMINA_OT_bake(bpy.types.Operator):
    bl_idname = "lamina.bake"
    bl_label = "Bake"
    bl_description = "Compute the layers and build the node group of this material. ESC cancels"
    bl_options = {"REGISTER", "UNDO"}

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
            self._job = bake_job.start(material)
        except Exception as error:
            return self._failed(material, error)
        self._timer = context.window_manager.event_timer_add(INTERVAL, window=context.window)
        self._workspace = context.workspace
        context.window_manager.modal_handler_add(self)
        self._tell(context, f"Lamina bakes {material.name} | ESC: Cancel")
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS" and not self._job.cancelling:
            self._job.cancel()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        redraw.properties()
        if not self._job.done:
            return {"PASS_THROUGH"}
        self._end(context)
        try:
            material = self._job.finish()
        except native.require().Cancelled:
            material = None
        except Exception as error:
            material = self._job.material()
            return self._failed(material, error) if material else {"CANCELLED"}
        if material is None:
            self.report({"INFO"}, "Bake cancelled; the earlier one is kept")
            return {"CANCELLED"}
        result = material.lamina.result
        seconds, fit = result.seconds, result.fit_error
        self.report({"INFO"}, f"Baked {material.name} in {seconds:.1f} s, fit error {messages.percent(fit)}")
        return {"FINISHED"}

    def cancel(self, context):
        """Blender ends the operator: another file, or the end of the session."""
        bake_job.stop()
        self._end(context)

    def _end(self, context):
        bake_job.forget()
        context.window_manager.event_timer_remove(self._timer)
        self._tell(context, None)
        redraw.properties()

    def _tell(self, _context, text):
        if self._workspace is not None:
            self._workspace.status_text_set(text)

    def _failed(self, material, error):
        self.report({"ERROR"}, bake_job.note_failure(material, error))
        index = messages.layer_index(str(error))
        if index is not None and index < len(material.lamina.layers):
            material.lamina.active_index = index
        return {"CANCELLED"}
