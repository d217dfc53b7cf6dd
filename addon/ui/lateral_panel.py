# SPDX-License-Identifier: GPL-3.0-or-later
"""The Lamina subpanel for lateral light transport."""

import bpy

from ..baking import lateral_job, portal_reach, volume_bounces
from ..nodes import node_group
from .fields import split
from .material_panel import MaterialPanel
from .sentences import draw_progress, draw_sentence


class LAMINA_PT_lateral(MaterialPanel, bpy.types.Panel):
    bl_label = "Lateral"
    bl_parent_id = "LAMINA_PT_main"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, material = self.layout, context.material
        layout.row().prop(material.lamina, "lateral", expand=True)
        if material.lamina.lateral == "PORTAL":
            split(layout.row()).prop(material.lamina, "lateral_orders")
        job = lateral_job.running_for(material)
        if job is not None:
            draw_progress(layout, job, "LATERAL")
            return
        layout.operator("lamina.lateral", icon="LIGHT_HEMI")
        if material.lamina.lateral_report and not node_group.shows_lateral(material):
            layout.label(text="Not connected to the output", icon="UNLINKED")
            return
        if sentence := lateral_job.stale(material):
            draw_sentence(context, layout, sentence, "FILE_REFRESH")
        if material.lamina.lateral_report:
            draw_sentence(context, layout, material.lamina.lateral_report)
        thin = portal_reach.too_thin(context.object, material, lateral_job.millimetre(context.scene))
        if thin:
            draw_sentence(context, layout, thin, "ERROR", alert=True)
        shortage = volume_bounces.shortage(context.scene, material)
        if shortage:
            draw_sentence(context, layout, shortage, "ERROR", alert=True)
            layout.operator("lamina.lateral_bounces", icon="LIGHT")


register, unregister = bpy.utils.register_classes_factory((LAMINA_PT_lateral,))
