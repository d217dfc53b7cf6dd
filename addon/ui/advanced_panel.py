# SPDX-License-Identifier: GPL-3.0-or-later
"""What few need: details of the active layer and of the base, the wanted quality and fit, the result's
curves, and its errors."""

import bpy

from ..base import editable
from ..base.messages import percent
from ..editing import layer_list
from ..stack_json import stack_write
from . import details, numbers, result_picture
from .material_panel import MaterialPanel
from .sentences import draw_lines


class LAMINA_PT_advanced(MaterialPanel, bpy.types.Panel):
    bl_label = "Advanced"
    bl_parent_id = "LAMINA_PT_main"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = 1  # below the panels of the material

    def draw(self, context):
        layout, settings = self.layout, context.material.lamina
        layout.active = editable.is_editable(context.material)
        layer = layer_list.active_layer(context.material)
        if layer is not None:
            layout.label(text=f"Layer “{layer.name}”")
            details.draw_layer(layout, layer)
        if settings.base.kind != "none":
            layout.label(text="Below")
            details.draw_base(layout, settings.base)
        if stack_write.has_spectra(settings):
            layout.prop(settings, "illuminant")
        layout.label(text="Result")
        layout.row(heading="Quality").prop(settings, "quality", expand=True)
        layout.row(heading="Fit").prop(settings, "basis", expand=True)
        result = settings.result
        if not result.stack_hash:
            return
        draw_lines(layout, numbers.below_lines(result))
        if not result_picture.draw(layout, context, context.material):  # a bake of an earlier version
            draw_lines(layout, numbers.result_lines(result))
            return
        header, body = layout.panel("lamina_numbers", default_closed=True)
        fit_error = result.report.get("fit_error")
        header.label(text="Numbers" if fit_error is None else f"Numbers (fit error {percent(fit_error)})")
        if body is not None:
            draw_lines(body, numbers.result_lines(result))
            draw_lines(body, numbers.thickness_lines(context.material))


register, unregister = bpy.utils.register_classes_factory((LAMINA_PT_advanced,))
