# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the properties of one layer, and of the base.

Labels are short because the editor is narrow; tooltips give the details.
"""

from ..base import native
from ..base.decimals import shortest
from ..editing import metals
from ..kinds import boundaries, media
from ..kinds.bases import BASES, Conductor
from ..stack_json import phases, profiles, solved_colours

NO_ALBEDO = "No albedo gives this color"


def draw_layer(layout, layer):
    """`layout`: of the panel, because a folded part needs its full width."""
    column = split(layout.column())
    column.prop(layer, "kind")
    if layer.kind == "interface":
        _draw_interface(column, layer)
        _draw_advanced(layout, layer, boundaries.Interface)
    else:
        _draw_medium(layout, layer)


def draw_base(layout, base):
    """`layout` is the panel's own."""
    column = split(layout.column())
    column.prop(base, "kind", text="Below")
    cls = BASES.get(base.kind)
    if cls is None:
        return
    if cls is Conductor:
        row = _labelled(column, "Metal", None)
        row.menu("LAMINA_MT_metals", text=_metal_name(base) or "Custom")
    if cls.form_prop:
        column.row().prop(base, cls.form_prop, expand=True)
    for field in cls.panel_fields(base):
        _draw_number(column, base, field)
    _draw_options(column, base, cls)
    if cls.has_phase:
        _draw_phase(column, base, is_base=True)
    _draw_advanced(layout, base, cls)


def facts(layer):
    """A layer in a few characters, for the list."""
    if layer.kind == "interface":
        ior = "/".join(f"{shortest(value):g}" for value in layer.ior_rgb) if layer.ior_per_channel else None
        ior = ior or f"{shortest(layer.ior):g}"
        return f"ior {ior}, rough {layer.roughness:.2g}" if layer.alpha > 0.0 else f"ior {ior}, smooth"
    if _is_infinite(layer):
        return "∞"
    if layer.mode == "coefficients":
        return f"{shortest(layer.thickness):g} mm"
    tau = max(layer.tau_rgb) if layer.tau_per_channel else layer.tau
    return f"thickness {shortest(tau):g}"


def split(layout):
    layout.use_property_split = True
    layout.use_property_decorate = False
    return layout


def _draw_interface(column, layer):
    if layer.ior_per_channel:
        _rgb_column(column, layer, "ior_rgb", "IOR")
    else:
        column.prop(layer, "ior")
    _draw_number(column, layer, boundaries.ALPHA)
    _draw_options(column, layer, boundaries.Interface)


def _draw_number(column, owner, field):
    if field is boundaries.ALPHA:  # the panel shows Blender's Roughness instead
        column.prop(owner, "roughness", slider=True)
    elif field.panel.rgb and field.panel.subtype != "COLOR":
        _rgb_column(column, owner, field.prop, field.panel.label)
    else:
        column.prop(owner, field.prop, slider=field.panel.slider)


def _draw_options(column, owner, cls):
    for option in cls.options:
        if not option.advanced:
            column.prop(owner, option.name)


def _draw_advanced(layout, owner, cls):
    names = [option.name for option in cls.options if option.advanced]
    if not names:
        return
    header, body = layout.panel("lamina_advanced", default_closed=True)
    header.label(text="Advanced")
    if body is not None:
        column = split(body.column())
        for name in names:
            column.prop(owner, name)
        if hasattr(owner, "ior_per_channel"):
            column.prop(owner, "ior_per_channel")


def _draw_medium(layout, layer):
    imported = profiles.imported(layer)
    if not imported:
        layout.row().prop(layer, "mode", expand=True)
    column = split(layout.column())
    if imported:
        row = _labelled(column, "Profile", f"Imported: {imported}")
        row.operator("lamina.profile_replace", text="", icon="X")
    else:
        _draw_medium_at(column, layer, layer)
    amount = "Largest Thickness" if layer.varying else "Thickness"
    if layer.mode == "coefficients":
        _with_infinity(column, layer, "thickness", f"{amount} (mm)")
    else:
        _draw_tau(column, layer, amount)
    column.prop(layer, "varying")
    if not imported:
        _draw_phase(column, layer)
    _draw_more_of_medium(layout, layer, imported)


def _draw_more_of_medium(layout, layer, imported):
    """The folded part of a medium: a color over a ground, channels, and what changes with depth."""
    has_tau = layer.mode != "coefficients" and not _is_infinite(layer)
    if imported and not has_tau:
        return
    header, body = layout.panel("lamina_medium_advanced", default_closed=True)
    header.label(text="Advanced")
    if body is None:
        return
    column = split(body.column())
    if not imported and layer.mode == "colour":
        _draw_albedo(column, layer)
        _draw_over(column, layer)
    if has_tau:
        column.prop(layer, "tau_per_channel")
    if imported:
        return
    column.prop(layer, "graded")
    if layer.graded:
        box = body.box()
        box.label(text="At the Bottom", icon="TRIA_DOWN_BAR")
        bottom = split(box.column())
        _draw_medium_at(bottom, layer, layer.bottom)
        if layer.mode == "colour":
            _draw_albedo(bottom, layer.bottom)
        _draw_phase(bottom, layer.bottom, is_bottom=True)


def _draw_medium_at(column, layer, end):
    """The scattering properties at the top, the layer itself, or at its bottom."""
    if layer.mode == "colour":
        column.prop(end, "colour")
        if solved_colours.albedo(end) == ():
            _labelled(column, "Albedo", NO_ALBEDO)
        return
    form = next(form for form in media.FORMS if form.item.id == layer.mode)
    for field in form.local:
        _draw_number(column, end, field)
    if native.available():  # otherwise the color is unknown, and the swatch black
        column.prop(end, "shown_colour", text="As Thick Layer")


def _draw_albedo(column, end):
    """The albedo that gives the layer's color."""
    albedo = solved_colours.albedo(end)
    waiting = "…" if albedo is None else NO_ALBEDO
    _labelled(column, "Albedo", "  ".join(f"{value:.3g}" for value in albedo) if albedo else waiting)


def _draw_over(column, layer):
    if layer.mode == "colour" and not _is_infinite(layer):
        row = column.row(heading="Seen Over")
        row.prop(layer, "over_given", text="")
        swatch = row.row()
        swatch.active = layer.over_given
        swatch.prop(layer, "over", text="")


def _draw_tau(column, layer, text):
    if layer.tau_per_channel and not _is_infinite(layer):
        _rgb_column(column, layer, "tau_rgb", text)
    else:
        _with_infinity(column, layer, "tau", text)


def _draw_phase(column, owner, is_base=False, is_bottom=False):
    imported = phases.imported(owner)
    if imported:
        row = _labelled(column, "Phase", f"Imported: {imported}")
        operator = row.operator("lamina.phase_replace", text="", icon="X")
        operator.base, operator.bottom = is_base, is_bottom
        return
    column.prop(owner, "phase", text="Phase")
    for field in phases.KINDS[owner.phase].fields:
        column.prop(owner, field.prop, slider=field.panel.slider)


def _metal_name(base):
    try:
        return metals.label(metals.name_of(base))
    except native.NativeMissingError:
        return ""


def _labelled(column, name, text):
    """A label and a text, aligned with the properties above and below. Returns the row of the text."""
    parts = column.split(factor=0.4)
    parts.use_property_split = False
    label = parts.row()
    label.alignment = "RIGHT"
    label.label(text=name)
    row = parts.row(align=True)
    if text is not None:
        row.label(text=text)
    return row


def _with_infinity(column, layer, name, text):
    """A number and its infinity switch; a medium that changes with depth has no such switch."""
    row = _labelled(column, text, None)
    value = row.row(align=True)
    value.active = not _is_infinite(layer)
    value.prop(layer, name, text="")
    if profiles.is_graded(layer):
        return
    switch = row.row(align=True)
    switch.ui_units_x = 1.6
    switch.prop(layer, "infinite", text="∞", toggle=True)


def _is_infinite(layer):
    return layer.infinite and not profiles.is_graded(layer)


def _rgb_column(column, owner, name, text):
    column = column.column(align=True)
    for index, channel in enumerate("RGB"):
        column.prop(owner, name, index=index, text=f"{text} {channel}" if index == 0 else channel)
