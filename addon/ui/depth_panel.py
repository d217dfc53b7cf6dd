# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of light below the surface: at the surface alone, soft, or followed through the object."""

import bpy

from ..baking import body_thickness, lateral_job, volume_bounces
from ..editing import depth
from ..nodes import node_group
from ..properties.material_properties import DEPTHS
from . import interior_fields, trial_fields
from .fields import split
from .material_panel import AnyMaterialPanel
from .sentences import draw_progress, draw_sentence


class LAMINA_PT_depth(AnyMaterialPanel, bpy.types.Panel):
    bl_label = "Depth"
    bl_parent_id = "LAMINA_PT_main"

    @classmethod
    def wanted(cls, material):
        settings = material.lamina
        has_depth = depth.has_lengths(material) or settings.lateral_group is not None
        return super().wanted(material) and (has_depth or not settings.enabled)

    def draw(self, context):
        layout, material = self.layout, context.material
        if not material.lamina.enabled:
            header, body = layout.panel("lamina_veins", default_closed=True)
            header.label(text="Veins")
            if body is not None:
                interior_fields.draw(context, body)
            return
        now = depth.chosen(material)
        row = layout.row(align=True)
        for choice, name, _description in DEPTHS:
            row.operator("lamina.depth", text=name, depress=now == choice).depth = choice
        if now == "SOFT":
            _draw_soft(context, layout)
        elif now != "SURFACE":
            interior_fields.draw(context, layout)


def _draw_soft(context, layout):
    material = context.material
    layout.row().prop(material.lamina, "lateral", expand=True)
    if material.lamina.lateral == "PORTAL":
        split(layout.row()).prop(material.lamina, "lateral_orders")
    job = lateral_job.running_for(material)
    if job is not None:
        draw_progress(layout, job, "LATERAL")
        return
    layout.operator("lamina.lateral", icon="LIGHT_HEMI")
    if not material.lamina.lateral_report:
        draw_sentence(context, layout, "Not computed yet: light stays at the surface")
    if material.lamina.lateral_report and not node_group.shows_lateral(material):
        layout.label(text="Not connected to the output", icon="UNLINKED")
        return
    if sentence := lateral_job.stale(material):
        draw_sentence(context, layout, sentence, "FILE_REFRESH")
    if material.lamina.lateral_report:
        draw_sentence(context, layout, material.lamina.lateral_report)
        trial_fields.draw(context, layout)
    millimetre = lateral_job.millimetre(context.scene)
    thin = body_thickness.too_thin(context.object, material, context.evaluated_depsgraph_get(), millimetre)
    if thin:
        draw_sentence(context, layout, thin, "ERROR", alert=True)
    shortage = volume_bounces.shortage(context.scene, material)
    if shortage:
        draw_sentence(context, layout, shortage, "ERROR", alert=True)
        layout.operator("lamina.lateral_bounces", icon="LIGHT")


register, unregister = bpy.utils.register_classes_factory((LAMINA_PT_depth,))
