# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws what few change of one layer, and of the base: how it is described, its phase function, its facets,
and what changes with depth."""

from ..kinds import boundaries, media
from ..kinds.bases import BASES
from ..kinds.measured import TableText
from ..stack_json import phases, profiles, solved_colours
from .fields import (
    NO_ALBEDO,
    draw_color,
    draw_number,
    draw_shown_color,
    draw_thickness,
    is_infinite,
    labelled,
    split,
)


def draw_layer(layout, layer):
    column = split(layout.column())
    column.prop(layer, "kind")
    if layer.kind == "interface":
        _draw_options(column, layer, boundaries.Interface)
        column.prop(layer, "ior_per_channel")
    elif layer.kind in ("flakes", "fibers"):
        column.prop(layer, "varying")
    elif layer.kind == "medium":
        column.prop(layer, "varying")
        if layer.varying:
            draw_thickness(column, layer, "Largest Thickness")
        _draw_medium(layout, layer)


def draw_base(layout, base):
    cls = BASES.get(base.kind)
    if cls is None:
        return
    column = split(layout.column())
    _draw_options(column, base, cls)
    if cls.has_phase:
        _draw_phase(column, base, is_base=True)


def _draw_options(column, owner, cls):
    for option in cls.options:
        if not isinstance(option, TableText):
            column.prop(owner, option.name)


def _draw_medium(layout, layer):
    imported = profiles.imported(layer)
    if not imported:
        layout.row().prop(layer, "mode", expand=True)
        layout.operator("lamina.match_colors", text="Match Two Colors...")
    column = split(layout.column())
    if not imported:
        _draw_end(column, layer, layer)
        _draw_over(column, layer)
    if layer.mode not in media.IN_MM and not is_infinite(layer):
        column.prop(layer, "tau_per_channel")
    if imported:
        return
    _draw_phase(column, layer)
    if layer.mode == "pigment":
        return
    column.prop(layer, "graded")
    if layer.graded:
        box = layout.box()
        box.label(text="At the Bottom", icon="TRIA_DOWN_BAR")
        bottom = split(box.column())
        draw_color(bottom, layer, layer.bottom)
        _draw_end(bottom, layer, layer.bottom)
        _draw_phase(bottom, layer.bottom, is_bottom=True)


def _draw_end(column, layer, end):
    """The numbers of a medium at its top, the layer itself, or at its bottom."""
    if layer.mode == "colour":
        _draw_albedo(column, end)
    elif layer.mode == "optical":
        draw_shown_color(column, end)
    elif layer.mode == "coefficients":
        for field in media.BY_COEFFICIENTS.local:
            draw_number(column, end, field)
    elif layer.mode == "pigment":
        draw_number(column, end, media.SIGMA_S)


def _draw_albedo(column, end):
    """The albedo that gives the layer's color."""
    albedo = solved_colours.albedo(end)
    waiting = "…" if albedo is None else NO_ALBEDO
    labelled(column, "Albedo", "  ".join(f"{value:.3g}" for value in albedo) if albedo else waiting)


def _draw_over(column, layer):
    if layer.mode == "colour" and not is_infinite(layer):
        row = column.row(heading="Seen Over")
        row.prop(layer, "over_given", text="")
        swatch = row.row()
        swatch.active = layer.over_given
        swatch.prop(layer, "over", text="")


def _draw_phase(column, owner, is_base=False, is_bottom=False):
    imported = phases.imported(owner)
    if imported:
        row = labelled(column, "Phase", f"Imported: {imported}")
        operator = row.operator("lamina.phase_replace", text="", icon="X")
        operator.base, operator.bottom = is_base, is_bottom
        return
    column.prop(owner, "phase", text="Phase")
    for field in phases.KINDS[owner.phase].fields:
        column.prop(owner, field.prop, slider=field.panel.slider)
