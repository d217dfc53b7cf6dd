# SPDX-License-Identifier: GPL-3.0-or-later
"""Add Lamina layers over what the material shows now."""

import bpy

from ..base.messages import RefusedError
from ..editing import over_material
from . import common

WIDTH = 380  # of the dialog


class LAMINA_OT_add_over(bpy.types.Operator):
    bl_idname = "lamina.add_over"
    bl_label = "Add Layers Over This Material"
    bl_description = (
        "Put layers over this material as it is, and bake a preview. Textures, bump, displacement, emission "
        "and alpha are kept. Remove Lamina from Material restores everything"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not common.can_edit(cls, context) or not common.has_native(cls) or not common.is_idle(cls):
            return False
        sentence = over_material.problem(common.material_of(context))
        if sentence:
            cls.poll_message_set(sentence)
        return not sentence

    def invoke(self, context, _event):
        """Ask first if something is lost."""
        if bpy.app.background or not over_material.not_carried(common.material_of(context)):
            return self.execute(context)
        return context.window_manager.invoke_props_dialog(
            self, width=WIDTH, title=self.bl_label, confirm_text="Add Layers"
        )

    def draw(self, context):
        column = self.layout.column(align=True)
        for text, icon in over_material.told(common.material_of(context), WIDTH // 7):
            column.label(text=text, icon=icon)

    def execute(self, context):
        material = common.material_of(context)
        try:
            over_material.add(material)
        except RefusedError as error:
            return common.refused(self, error)
        # In a window, the bake runs beside the artist's work, and its own operator reports a failure.
        with context.temp_override(material=material):
            bpy.ops.lamina.bake("INVOKE_DEFAULT")
        return {"FINISHED"}
