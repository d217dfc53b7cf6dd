# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels of the varying layer's thickness and of the varying interface's coverage: the source of each,
and the fit error there."""

import bpy

from ..base.messages import percent
from ..nodes import detail_wiring, dust_detail, thickness
from ..nodes.group_sockets import COVERAGE
from ..nodes.side_graph import FRONT
from .fields import split
from .material_panel import MaterialPanel
from .sentences import draw_lines, draw_sentence
from .uv_map_field import draw_uv_map

SHOWN_ROWS = 5


class LAMINA_PT_thickness(MaterialPanel, bpy.types.Panel):
    bl_label = "Thickness"
    bl_parent_id = "LAMINA_PT_main"

    @classmethod
    def wanted(cls, material):
        return super().wanted(material) and thickness.has_input(material)

    def draw(self, context):
        layout, material = self.layout, context.material
        layout.active = material.is_editable
        now = _draw_source(context, layout, material, FRONT, "Optical Thickness")
        _draw_detail(layout, material)
        draw_lines(layout, error_lines(material.lamina.result, now))


class LAMINA_PT_coverage(MaterialPanel, bpy.types.Panel):
    bl_label = "Coverage"
    bl_parent_id = "LAMINA_PT_main"

    @classmethod
    def wanted(cls, material):
        return super().wanted(material) and thickness.has_input(material, COVERAGE)

    def draw(self, context):
        self.layout.active = context.material.is_editable
        _draw_source(context, self.layout, context.material, COVERAGE, "Coverage")


def _draw_source(context, layout, material, name, label):
    """The source of the input `name`, of thickness.INPUTS. Returns its Wiring."""
    now = thickness.wiring(material, name)
    row = layout.row(align=True)
    for source in thickness.SOURCES:
        button = row.operator("lamina.thickness_wire", text=source.capitalize(), depress=now.source == source)
        button.source, button.input = source.upper(), name.upper()
        button.replace = False
    column = layout.column()
    column.use_property_split, column.use_property_decorate = True, False
    if now.source == "value":
        column.prop(now.socket, "default_value", text=label)
    elif now.source == "attribute":
        column.prop(now.node, "attribute_name", text="Attribute")
        if not _has_attribute(context, now.name):
            draw_sentence(context, layout, f"This object has no attribute “{now.name}”: {label.lower()} 0")
    elif now.source == "image":
        column.template_ID(now.node, "image", new="image.new", open="image.open")
        if now.uv is not None and context.object is not None and context.object.type == "MESH":
            draw_uv_map(context, column, now.uv, context.object)
        problem = thickness.image_problem(now.node.image)
        if problem:
            draw_sentence(context, layout, problem, "ERROR", alert=True)
    else:
        layout.label(text=f"Linked to “{now.name}”", icon="NODE")
    return now


def _draw_detail(layout, material):
    """The noise on the thickness and the painted mask: inputs of a node group, which the viewport follows."""
    node = detail_wiring.detail(material)
    row = layout.row(align=True)
    if node is not None:
        column = split(layout.column(align=True))
        for name, *_rest in dust_detail.SETTINGS:
            if not node.inputs[name].is_linked:
                column.prop(node.inputs[name], "default_value", text=name)
        row.operator("lamina.dust_detail", text="Remove Grain and Clouds", icon="X").remove = True
    else:
        row.operator("lamina.dust_detail", icon="MOD_NOISE")
    row.operator("lamina.dust_wipe", icon="BRUSH_DATA")


def _has_attribute(context, name):
    """True if the evaluated active object has the attribute; other objects are not checked."""
    thing = context.object
    if thing is None:
        return True
    if thing.type != "MESH":
        return False
    return name in thing.evaluated_get(context.evaluated_depsgraph_get()).data.attributes


def error_lines(result, now):
    """(name, value) of the fit error by thickness: at the value, or at some rows; and between rows."""
    report = result.report
    if not report.get("row_errors"):
        return []
    rows = list(zip(*(report["row_errors"][name] for name in ("tau", "mean", "worst")), strict=True))
    if now.source == "value":
        tau = now.socket.default_value
        rows = [min(rows, key=lambda row: abs(row[0] - tau))]
    else:
        last = len(rows) - 1
        rows = [rows[round(last * k / (SHOWN_ROWS - 1))] for k in range(SHOWN_ROWS)]
    lines = []
    for tau, mean, worst in rows:
        lines.append((f"Error at {tau:.2g}", f"{percent(mean)} mean, {percent(worst)} worst"))
    between = report.get("tau_error")
    if between:
        text = f"{percent(between['mean'], 2)} mean, {percent(between['worst'])} worst"
        lines.append(("Between Rows", text))
    return lines


register, unregister = bpy.utils.register_classes_factory((LAMINA_PT_thickness, LAMINA_PT_coverage))
