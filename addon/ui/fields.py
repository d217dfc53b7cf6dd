# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws what most change of one layer, and of the base; `details` draws the rest.

Labels are short because the editor is narrow; tooltips give the details.
"""

import math

import bpy

from ..base import native, preferences, uv_maps
from ..base.decimals import shortest
from ..editing import metals, sparkle
from ..kinds import boundaries, media
from ..kinds.bases import BASES, Conductor, Measured
from ..kinds.fields import Option, panel_fields
from ..kinds.flakes import BY_COLOUR, BY_FILM, COAT, COAT_THICKNESS
from ..kinds.layers import DESCRIBED
from ..stack_json import coats, profiles, solved_colours

NO_ALBEDO = "No albedo gives this color"


def draw_layer(layout, layer):
    column = split(layout.column())
    draw = {"interface": _draw_interface, "medium": _draw_medium}
    draw.get(layer.kind, _draw_described)(column, layer)


def draw_base(layout, base):
    """`layout` is the panel's own."""
    column = split(layout.column())
    column.prop(base, "kind", text="Material")
    cls = BASES.get(base.kind)
    if cls is None:
        return
    if cls is Conductor and base.metal_form != "spectrum":
        row = labelled(column, "Metal", None)
        row.menu("LAMINA_MT_metals", text=_metal_name(base) or "Custom")
    if cls is Measured:
        row = labelled(column, cls.options[0].label, None)
        row.operator("lamina.measured_base", text=base.measured_name or "Choose...", icon="FILEBROWSER")
    if cls.form_prop:
        column.row().prop(base, cls.form_prop, expand=True)
    for field in panel_fields(cls, base):
        draw_number(column, base, field)


def facts(layer):
    """A layer in a few characters, for the list."""
    if layer.kind == "interface":
        ior = "/".join(f"{shortest(value):g}" for value in layer.ior_rgb) if layer.ior_per_channel else None
        ior = ior or f"{shortest(layer.ior):g}"
        return f"ior {ior}, rough {layer.roughness:.2g}" if layer.alpha > 0.0 else f"ior {ior}, smooth"
    if layer.kind == "film":
        return f"ior {shortest(layer.film_ior):g}, {shortest(layer.film_thickness):g} nm"
    if layer.kind == "flakes":
        return f"amount {shortest(layer.flake_tau):g}, spread {shortest(layer.flake_alpha):g}"
    if layer.kind == "fibers":
        return f"amount {shortest(layer.fiber_tau):g}, lean {math.degrees(layer.fiber_tilt):.0f}°"
    if is_infinite(layer):
        return "∞"
    if layer.mode in media.IN_MM:
        return f"{shortest(layer.thickness):g} mm"
    tau = max(layer.tau_rgb) if layer.tau_per_channel else layer.tau
    return f"thickness {shortest(tau):g}"


def split(layout):
    layout.use_property_split = True
    layout.use_property_decorate = False
    return layout


def _draw_interface(column, layer):
    if layer.ior_per_channel:
        rgb_column(column, layer, "ior_rgb", "IOR")
    else:
        column.prop(layer, "ior")
    draw_number(column, layer, boundaries.ALPHA)


def _draw_described(column, layer):
    cls = DESCRIBED[layer.kind]
    if getattr(cls, "forms", ()):
        narrow = len(cls.forms) > 3  # the names would be cut
        column.row().prop(layer, cls.form_prop, expand=not narrow)
    for field in panel_fields(cls, layer):
        draw_number(column, layer, field)
    if layer.kind == "flakes":
        if layer.flake_form == BY_COLOUR.item.id:
            column.prop(layer, "pearl")
        _draw_coats(column, layer)
        _draw_sparkle(column, layer.id_data)


def _draw_coats(column, layer):
    """The films on flakes."""
    imported = coats.imported(layer)
    if imported:
        row = labelled(column, "Films", f"Imported: {imported}")
        row.operator("lamina.coats_replace", text="", icon="X")
        if coats.has_own_thickness(layer):
            draw_number(column, layer, COAT_THICKNESS)
    elif layer.flake_form == BY_FILM.item.id:
        for field in COAT:
            draw_number(column, layer, field)


def _draw_sparkle(column, material):
    is_on = sparkle.is_on(material)
    if is_on:
        for name, socket in sparkle.sockets(material).items():
            if not socket.is_linked:
                column.prop(socket, "default_value", text=name)
    column.operator("lamina.sparkle", text="Fade by Camera" if is_on else "Sparkle", icon="SHADERFX")


def _draw_medium(column, layer):
    imported = profiles.imported(layer)
    if imported:
        row = labelled(column, "Profile", f"Imported: {imported}")
        row.operator("lamina.profile_replace", text="", icon="X")
    else:
        draw_color(column, layer, layer)
    if not layer.varying:
        draw_thickness(column, layer, "Thickness")


def draw_thickness(column, layer, text):
    """The thickness of a medium; of a varying one, the largest: Advanced has it."""
    if layer.mode in media.IN_MM:
        _with_infinity(column, layer, "thickness", f"{text} (mm)")
    elif layer.tau_per_channel and not is_infinite(layer):
        rgb_column(column, layer, "tau_rgb", text)
    else:
        _with_infinity(column, layer, "tau", text)


def draw_color(column, layer, end):
    """The color of a medium at its top, the layer itself, or at its bottom."""
    if layer.mode == "colour":
        column.prop(end, "colour")
        if solved_colours.albedo(end) == ():
            labelled(column, "Albedo", NO_ALBEDO)
        return
    if layer.mode == "optical":
        column.prop(end, "albedo")
    elif layer.mode == "pigment":
        for quantity in (media.PIGMENT, media.AMOUNT):
            draw_number(column, layer, quantity)
    if layer.mode != "optical":  # then the panel has the albedo, and Advanced the color
        draw_shown_color(column, end)


def draw_shown_color(column, end):
    """The color of a thick layer, if the native package is there; otherwise the swatch would be black."""
    if native.available():
        column.prop(end, "shown_colour", text="As Thick Layer")


def draw_number(column, owner, field):
    if field is boundaries.ALPHA:  # the panel shows Blender's Roughness instead
        column.prop(owner, "roughness", slider=True)
        if owner.alpha > 0.0:
            _draw_orientation(column, owner)
    elif isinstance(field, Option):
        column.prop(owner, field.prop)
    elif field.panel.rgb and field.panel.subtype != "COLOR":
        rgb_column(column, owner, field.prop, field.panel.label)
    else:
        column.prop(owner, field.prop, slider=field.panel.slider)


def _draw_orientation(column, owner):
    row = column.row()
    row.enabled = owner.anisotropic or preferences.shows_anisotropy()
    row.prop(owner, "anisotropic")
    if owner.anisotropic:
        column.prop(owner, "roughness_v", slider=True)
        column.prop(owner, "angle")
        column.prop(owner.id_data.lamina, "tangent")
        if owner.id_data.lamina.tangent == "UV" and uv_maps.has_none(bpy.context):
            column.label(text="The mesh has no UV map", icon="ERROR")


def _metal_name(base):
    try:
        return metals.label(metals.name_of(base))
    except native.NativeMissingError:
        return ""


def labelled(column, name, text):
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
    row = labelled(column, text, None)
    value = row.row(align=True)
    value.active = not is_infinite(layer)
    value.prop(layer, name, text="")
    if profiles.is_graded(layer):
        return
    switch = row.row(align=True)
    switch.ui_units_x = 1.6
    switch.prop(layer, "infinite", text="∞", toggle=True)


def is_infinite(layer):
    return layer.infinite and not profiles.is_graded(layer)


def rgb_column(column, owner, name, text):
    column = column.column(align=True)
    for index, channel in enumerate("RGB"):
        column.prop(owner, name, index=index, text=f"{text} {channel}" if index == 0 else channel)
