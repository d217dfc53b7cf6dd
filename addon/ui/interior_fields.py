# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the interior of the active object: what fills it, what is computed from it, and the job."""

import bpy

from ..base import messages, native, rendered
from ..interior import body, contents, freshness, interior_job, motion
from ..kinds import interiors
from ..nodes import node_group
from . import trial_fields
from .fields import split
from .sentences import draw_progress, draw_sentence
from .uv_map_field import draw_uv_map

FIRST = 2  # numbers of marble that are not folded: the veins' spacing and width


class LAMINA_MT_end_presets(bpy.types.Menu):
    """Presets of one end material; which one is a property of the panel's row."""

    bl_label = "Material"
    bl_description = "Take the coefficients per mm of a preset of the library"
    second = False

    def draw(self, _context):
        try:
            found = contents.presets()
        except (native.NativeMissingError, ValueError) as error:
            self.layout.label(text=messages.sentence(error), icon="ERROR")
            return
        for name, label in found:
            choice = self.layout.operator("lamina.end_preset", text=label)
            choice.preset, choice.second = name, self.second


class LAMINA_MT_vein_presets(LAMINA_MT_end_presets):
    second = True


def draw(context, layout):
    obj, material = context.object, context.material
    settings = material.lamina.interior
    if settings.source != "LAYERS" or not material.lamina.enabled:
        row = layout.row(align=True)
        for name in ("MARBLE", "NODES"):
            row.prop_enum(settings, "source", name)
    if settings.source != "LAYERS":
        _draw_ends(layout, material, settings)
    _draw_output(context, layout, settings)
    job = interior_job.running_for(material)
    if job is not None:
        draw_progress(layout, job, "INTERIOR")
        if job.shows:
            draw_sentence(context, layout, settings.report)
        return
    row = layout.row()
    row.scale_y = 1.4
    row.operator("lamina.interior", icon="LIGHT_HEMI")
    is_shown = node_group.shows_lateral(material)
    if problem := interior_job.problem(obj, material):
        draw_sentence(context, layout, problem, "ERROR")
        _draw_mend(layout, obj, material)
    elif is_shown and (stale := freshness.stale(context, obj, material)):
        draw_sentence(context, layout, stale, "ERROR")
    elif moving := motion.sentence(context, obj, settings):
        draw_sentence(context, layout, moving, "INFO")
    elif coarse := contents.too_coarse(context, obj, settings):
        draw_sentence(context, layout, coarse)
    if settings.report and is_shown:
        draw_sentence(context, layout, settings.report)
        trial_fields.draw(context, layout)
    elif settings.report:
        layout.label(text="Not connected to the output", icon="UNLINKED")
    if material.lamina.lateral_group is not None and not material.lamina.enabled:
        # Materials with layers have this in the menu beside their list.
        layout.operator("lamina.remove_stack", icon="X")


def _draw_mend(layout, obj, material):
    """A button that mends what the sentence above is about, if there is one."""
    if rendered.can_convert(obj):
        layout.operator("object.convert", text="Convert to Mesh", icon="MESH_DATA").target = "MESH"
    if body.problem(obj):
        return
    if interior_job.sharing(obj, material):
        layout.operator("lamina.interior_copy", icon="DUPLICATE")
    elif modifier := interior_job.copying_modifier(obj, material):
        button = layout.operator("object.modifier_apply", text=f"Apply {modifier}", icon="CHECKMARK")
        button.modifier, button.single_user = modifier, True


def _draw_ends(layout, material, settings):
    column = split(layout.column())
    if settings.source == "MARBLE":
        _draw_numbers(column, settings, interiors.MARBLE[:FIRST])
        more = _folded(layout, "lamina_vein_shape", "Shape of the Veins")
        if more is not None:
            _draw_numbers(more, settings, interiors.MARBLE[FIRST:])
            more.prop(settings, "direction")
    elif material.node_tree is not None:
        column.prop_search(settings, "node", material.node_tree, "nodes", text="Texture Node")
        if settings.node:
            column.prop(settings, "socket")
    menus = ("LAMINA_MT_end_presets", "LAMINA_MT_vein_presets")
    titles = ("Ground", "Veins") if settings.source == "MARBLE" else ("At 0", "At 1")
    ends = settings.first, settings.second
    for title, end, menu in zip(titles, ends, menus, strict=True):
        row = layout.row()
        row.label(text=title)
        row.menu(menu, text=end.preset or "Material")
    more = _folded(layout, "lamina_vein_numbers", "Coefficients per mm and Surface")
    if more is not None:
        for title, end in zip(titles, ends, strict=True):
            more.label(text=title)
            _draw_numbers(more, end, interiors.GROUND)
        _draw_numbers(more, settings, interiors.BODY)


def _folded(layout, name, title):
    """The column of a part that is folded at first; None while it is folded."""
    header, body = layout.panel(name, default_closed=True)
    header.label(text=title)
    return None if body is None else split(body.column())


def _draw_output(context, layout, settings):
    obj = context.object
    layout.row().prop(settings, "output", expand=True)
    column = _folded(layout, "lamina_interior_map", "View, Map and Noise")
    if column is None:
        return
    if settings.output == "LIT":
        column.row().prop(settings, "view", expand=True)
    column.row().prop(settings, "map", expand=True)
    if settings.map == "OWN" and obj is not None and obj.type == "MESH":
        if obj.data.uv_layers:
            draw_uv_map(context, column, settings, obj)
        else:
            draw_sentence(context, column, f"{obj.name} has no UV map: Lamina unwraps it")
    _draw_numbers(column, settings, interiors.MAPS)


def _draw_numbers(column, owner, fields):
    for field in fields:
        if field.panel is not None:
            column.prop(owner, field.prop)


register, unregister = bpy.utils.register_classes_factory((LAMINA_MT_end_presets, LAMINA_MT_vein_presets))
