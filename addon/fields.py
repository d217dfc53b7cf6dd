# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the numbers of one layer, and of the base.

Labels are short, for the editor is narrow; tooltips say the rest.
"""

from . import metals, native, phases, shown
from .decimals import shortest


def draw_layer(layout, layer):
    """`layout` is the panel's own: a folded part needs its full width."""
    column = split(layout.column())
    column.prop(layer, "kind")
    if layer.kind == "interface":
        _draw_interface(column, layer)
        _draw_advanced(layout, layer)
    else:
        _draw_medium(layout, layer)


def draw_base(layout, base):
    """`layout` is the panel's own."""
    column = split(layout.column())
    column.prop(base, "kind", text="Below")
    if base.kind == "lambert":
        column.prop(base, "reflectance")
        column.prop(base, "textured")
    elif base.kind == "half-space":
        column.prop(base, "albedo")
        _draw_phase(column, base, is_base=True)
    elif base.kind == "conductor":
        _draw_metal(column, base)
        _draw_facets(column, base)
        _draw_advanced(layout, base)


def facts(layer):
    """A layer in a few characters, for the list."""
    if layer.kind == "interface":
        ior = "/".join(f"{shortest(value):g}" for value in layer.ior_rgb) if layer.ior_per_channel else None
        ior = ior or f"{shortest(layer.ior):g}"
        return f"ior {ior}, rough {layer.roughness:.2g}" if layer.alpha > 0.0 else f"ior {ior}, smooth"
    if layer.infinite:
        return "∞"
    if layer.mode == "coefficients":
        return f"{shortest(layer.thickness):g} mm"
    tau = max(layer.tau_rgb) if layer.tau_per_channel else layer.tau
    return f"τ {shortest(tau):g}"


def split(layout):
    layout.use_property_split = True
    layout.use_property_decorate = False
    return layout


def _draw_interface(column, layer):
    if layer.ior_per_channel:
        _rgb_column(column, layer, "ior_rgb", "IOR")
    else:
        column.prop(layer, "ior")
    _draw_facets(column, layer)


def _draw_facets(column, owner):
    column.prop(owner, "roughness", slider=True)
    column.prop(owner, "distribution")


def _draw_advanced(layout, owner):
    header, body = layout.panel("lamina_advanced", default_closed=True)
    header.label(text="Advanced")
    if body is not None:
        column = split(body.column())
        column.prop(owner, "compensate")
        column.prop(owner, "correlated")
        if hasattr(owner, "ior_per_channel"):
            column.prop(owner, "ior_per_channel")


def _draw_medium(layout, layer):
    layout.row().prop(layer, "mode", expand=True)
    column = split(layout.column())
    amount = "Largest" if layer.varying else "Thickness"
    if layer.mode == "coefficients":
        _rgb_column(column, layer, "sigma_s", "Scattering")
        _rgb_column(column, layer, "sigma_a", "Absorption")
        _with_infinity(column, layer, "thickness", f"{amount} mm")
        column.prop(layer, "shown_colour", text="As Thick Layer")
    else:
        if layer.mode == "colour":
            _draw_colour(column, layer)
        else:
            column.prop(layer, "albedo")
            column.prop(layer, "shown_colour", text="As Thick Layer")
        _draw_tau(column, layer, f"{amount} τ")
    column.prop(layer, "varying", text="Varying")
    _draw_phase(column, layer)


def _draw_colour(column, layer):
    column.prop(layer, "colour")
    if not layer.infinite:
        row = column.row(heading="Over")
        row.prop(layer, "over_given", text="")
        swatch = row.row()
        swatch.active = layer.over_given
        swatch.prop(layer, "over", text="")
    albedo = shown.albedo(layer)
    waiting = "…" if albedo is None else "None shows this"
    _labelled(column, "Albedo", "  ".join(f"{value:.3g}" for value in albedo) if albedo else waiting)


def _draw_tau(column, layer, text):
    if layer.tau_per_channel and not layer.infinite:
        _rgb_column(column, layer, "tau_rgb", text)
    else:
        _with_infinity(column, layer, "tau", text)
    if not layer.infinite:
        column.prop(layer, "tau_per_channel")


def _draw_phase(column, owner, is_base=False):
    imported = phases.imported(owner)
    if imported:
        row = _labelled(column, "Phase", f"Imported: {imported}")
        row.operator("lamina.phase_replace", text="", icon="X").base = is_base
        return
    column.prop(owner, "phase", text="Phase")
    for prop in phases.FIELDS[owner.phase].values():
        column.prop(owner, prop, slider=prop != "draine_alpha")


def _draw_metal(column, base):
    column.row().prop(base, "metal_form", expand=True)
    if base.metal_form == "colours":
        column.prop(base, "facing")
        column.prop(base, "grazing")
        return
    row = _labelled(column, "Metal", None)
    row.menu("LAMINA_MT_metals", text=_metal_name(base) or "Custom")
    _rgb_column(column, base, "eta", "Index n")
    _rgb_column(column, base, "k", "Extinction k")


def _metal_name(base):
    try:
        return metals.label(metals.name_of(base))
    except native.NativeMissingError:
        return ""


def _labelled(column, name, text):
    """A line of text, lined up with the properties above and below; its row, for more."""
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
    """A number with its infinity switch."""
    row = _labelled(column, text, None)
    value = row.row(align=True)
    value.active = not layer.infinite
    value.prop(layer, name, text="")
    switch = row.row(align=True)
    switch.ui_units_x = 1.6
    switch.prop(layer, "infinite", text="∞", toggle=True)


def _rgb_column(column, owner, name, text):
    column = column.column(align=True)
    for index, channel in enumerate("RGB"):
        column.prop(owner, name, index=index, text=f"{text} {channel}" if index == 0 else channel)
