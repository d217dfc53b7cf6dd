# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of the place of the active layer: even, settled, painted, or by an image."""

import bpy

from ..base import editable
from ..editing import depth, layer_list
from ..nodes import detail_wiring, displacement, dust_detail, film_wiring, thickness
from ..nodes.film_pattern import PATTERNS
from ..nodes.side_graph import FRONT
from ..scene import place
from ..settling import dust_job, stamps
from . import settled_fields
from .fields import split
from .material_panel import MaterialPanel
from .sentences import draw_progress, draw_sentence
from .uv_map_field import draw_uv_map


class LAMINA_PT_where(MaterialPanel, bpy.types.Panel):
    bl_label = "Where"
    bl_parent_id = "LAMINA_PT_main"

    @classmethod
    def wanted(cls, material):
        has_place = layer_list.active_layer(material) is not None and depth.shows_layers(material)
        return super().wanted(material) and has_place

    def draw_header_preset(self, context):
        self.layout.label(text=layer_list.active_layer(context.material).name)

    def draw(self, context):
        layout, material = self.layout, context.material
        layout.active = editable.is_editable(material)
        layer = layer_list.active_layer(material)
        now = place.of(material, layer)
        choices = place.choices(layer)
        grid = layout.grid_flow(row_major=True, columns=3 if len(choices) > 4 else len(choices), align=True)
        for choice, name, _description in place.PLACES:
            if choice in choices:
                grid.operator("lamina.place", text=name, depress=now == choice).place = choice
        job = dust_job.running()
        if job is not None:
            draw_progress(layout, job, "DUST")
        elif layer.varying:
            _draw_source(context, layout, material, place.INPUTS[layer.kind], now)
            if layer.kind == "interface":
                _draw_pattern(layout, material, now)
            elif thickness.has_input(material):
                _draw_detail(layout, material)
            if stamps.is_painting(context):
                _draw_stamps(context, layout)


def _draw_source(context, layout, material, name, now):
    """What feeds this input of the node group."""
    wiring, column = thickness.wiring(material, name), split(layout.column())
    label = "Optical Thickness" if name == FRONT else name
    if now == place.SETTLED:
        settled_fields.draw(context, layout, name)
    elif wiring.source == "value":
        if name == FRONT or film_wiring.node_of(material) is None:  # a pattern has its amount
            column.prop(wiring.socket, "default_value", text=label)
    elif wiring.source == "attribute":
        column.prop(wiring.node, "attribute_name", text="Attribute")
        if not _has_attribute(context, wiring.name):
            draw_sentence(context, layout, f"This object has no attribute “{wiring.name}”: {label.lower()} 0")
    elif wiring.source == "image":
        column.template_ID(wiring.node, "image", new="image.new", open="image.open")
        if wiring.uv is not None and context.object is not None and context.object.type == "MESH":
            draw_uv_map(context, column, wiring.uv, context.object)
        problem = thickness.image_problem(wiring.node.image)
        if problem:
            draw_sentence(context, layout, problem, "ERROR", alert=True)
        elif name != FRONT:
            layout.operator("lamina.film_paint", icon="BRUSH_DATA")
    elif wiring.source == "custom":
        layout.label(text=f"Linked to “{wiring.name}”", icon="NODE")


def _draw_detail(layout, material):
    """The noise on the thickness and the painted mask: inputs of a node group, which the viewport follows."""
    layout.operator("lamina.dust_wipe", icon="BRUSH_DATA")
    header, body = layout.panel("lamina_grain", default_closed=True)
    header.label(text="Grain and Clouds")
    if body is None:
        return
    node = detail_wiring.detail(material)
    if node is None:
        body.operator("lamina.dust_detail", text="Add Grain and Clouds", icon="MOD_NOISE")
        return
    column = split(body.column(align=True))
    for name, *_rest in dust_detail.SETTINGS:
        if not node.inputs[name].is_linked and name != "Wiped":
            column.prop(node.inputs[name], "default_value", text=name)
    raised = displacement.node(material)
    if raised is None:
        body.operator("lamina.displace", icon="MOD_DISPLACE")
    else:
        row = split(body.column(align=True))
        row.prop(raised.inputs["Scale"], "default_value", text="Height of Thickness 1")
        body.operator("lamina.displace", text="Remove Displacement", icon="X").remove = True
    body.operator("lamina.dust_detail", text="Remove Grain and Clouds", icon="X").remove = True


def _draw_stamps(context, layout):
    row, now = layout.row(align=True), stamps.chosen(context)
    for key, stamp in stamps.STAMPS.items():
        row.operator("lamina.stamp", text=stamp.name, depress=now == key).stamp = key


def _draw_pattern(layout, material, now):
    """The settings of drops, puddles or prints, with their name where the film has another place as well."""
    node, pattern = film_wiring.node_of(material), film_wiring.chosen(material)
    if node is None:
        return
    if now != pattern:
        layout.label(text=f"In {pattern.capitalize()}")
    column = split(layout.column(align=True))
    for name, *_rest in PATTERNS[pattern].settings:
        if not node.inputs[name].is_linked:
            column.prop(node.inputs[name], "default_value", text=name)


def _has_attribute(context, name):
    """True if the evaluated active object has the attribute; other objects are not checked."""
    thing = context.object
    if thing is None:
        return True
    if thing.type != "MESH":
        return False
    return name in thing.evaluated_get(context.evaluated_depsgraph_get()).data.attributes


register, unregister = bpy.utils.register_classes_factory((LAMINA_PT_where,))
