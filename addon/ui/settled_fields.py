# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the dust on the active object: how much falls from where, where it stays, and the job."""

from ..base.messages import RefusedError
from ..kinds.dust import GROUPS, OPTIONS
from ..nodes import dust_strength, thickness
from ..nodes.side_graph import FRONT
from ..settling import dust_frames, dust_settings, live_dust, object_dust
from .fields import split
from .sentences import draw_sentence
from .uv_map_field import draw_uv_map

BACK_MATTERS = 0.05  # share of the largest thickness
_MAIN = ("repose",)  # options that are not folded, with the amount and the wind


def draw(context, layout, name=FRONT):
    """The dust of the active object, whose material is that of the panel and reads it by the input `name`."""
    obj = context.object
    sentence = object_dust.problem(obj)
    if sentence:
        draw_sentence(context, layout, sentence, "ERROR" if object_dust.unavailable() else "INFO")
        return
    settings, strength = obj.lamina_dust, dust_strength.socket()
    column = split(layout.column())
    if strength is not None:
        column.prop(strength, "default_value", text="Strength of All Dust")
    for option in OPTIONS:
        if option.name in ("amount" if settings.form == "tau" else "grams", *_MAIN):
            _draw_option(column, settings, option)
    column.prop(settings, "wind")
    text = "Settle Again" if settings.told else "Settle Dust"
    layout.operator("lamina.dust_settle", text=text, icon="FORCE_FORCE")
    _draw_state(context, layout, obj, name)
    header, body = layout.panel("lamina_dust_more", default_closed=True)
    header.label(text="More")
    if body is not None:
        row = body.row(align=True)
        row.prop(settings, "live", toggle=True)
        if settings.told:
            row.operator("lamina.dust_clear", icon="TRASH")
        for name, heading in GROUPS:
            body.label(text=heading)
            _DRAWN[name](context, body, obj)


def _draw_state(context, layout, obj, name):
    """Why the dust is not what the settings say, what was settled, and what the material does not show."""
    settings = obj.lamina_dust
    sentence = object_dust.advice(obj, obj.evaluated_get(context.evaluated_depsgraph_get()))
    if sentence:
        draw_sentence(context, layout, sentence, "INFO")
        layout.operator("lamina.dust_image", icon="IMAGE_DATA")
    if live_dust.failure(obj):
        draw_sentence(context, layout, live_dust.failure(obj), "ERROR", alert=True)
    if not settings.told:
        return
    if dust_settings.is_outdated(settings) and not live_dust.is_pending(obj):
        text = "Settled with few rays" if settings.settled == object_dust.PARTLY else "Out of date"
        draw_sentence(context, layout, f"{text}: Settle Again uses all settings", "FILE_REFRESH")
    draw_sentence(context, layout, settings.told[0].upper() + settings.told[1:])
    sentence = mismatch(context.material, settings, name)
    if sentence:
        draw_sentence(context, layout, sentence, "ERROR")


def mismatch(material, settings, name=FRONT):
    """The reason why the material does not show the dust correctly by its input `name`, or ''."""
    found = thickness.wiring(material, name)
    if found.source == "none":
        return "The material has no thickness input: choose Settled for its layer of dust"
    if found.source != settings.target:
        text = f"The material does not read it: its {name.lower()} comes from {found.source} {found.name}"
        return text.rstrip()
    if found.source == "image" and found.node.image != settings.image:
        return (f"The material reads the image {found.name} in place of this object's dust: give the object "
                "a material of its own, and settle again")
    if name != FRONT:
        return ""
    most = material.lamina.node_group.get("lamina_largest_tau", -1.0)
    if 0.0 <= most < settings.largest:
        return (f"Thicker than baked: above thickness {most:.3g} nothing changes. "
                "Choose Settled again, or raise Largest Thickness in Advanced")
    if settings.largest_back > BACK_MATTERS * settings.largest and not material.lamina.node_group.get(
            "lamina_shows_back", True):
        return ("Dust on back faces is not shown: this sheet has two different sides, and its dust layer is "
                "that of the front. Flip the normals of faces that look down")
    return ""


def _draw_amount(context, layout, obj):
    settings = obj.lamina_dust
    layout.row().prop(settings, "form", expand=True)
    column = split(layout.column())
    if settings.form == "mass":
        column.prop(settings, "substance")
    _draw_options(column, settings, "amount")
    column.prop(settings, "over_frames")
    if settings.over_frames:
        column.row().prop(settings, "frames_as", expand=True)
        for name in ("frame_first", "frame_last", "frame_step"):
            column.prop(settings, name)
        draw_sentence(context, layout, _frames_told(obj))


def _frames_told(obj):
    """The number of settlings, and the memory of those that are kept, before they are made."""
    try:
        frames = dust_frames.wanted(obj.lamina_dust)
    except RefusedError as error:
        return str(error)
    told = f"Settles at {len(frames)} frames, {frames[0]} to {frames[-1]}"
    if obj.lamina_dust.frames_as == "follow":
        kept = dust_frames.size(dust_frames.kept_bytes(obj.data, obj.lamina_dust))
        told += f"; the mesh then holds up to {kept} of dust"
    return told


def _draw_from(_context, layout, obj):
    settings = obj.lamina_dust
    column = split(layout.column())
    _draw_options(column, settings, "from")
    row = column.row()
    row.active = settings.wind > 0.0
    row.prop(settings, "wind_from")
    column.prop(settings, "others")


def _draw_stay(_context, layout, obj):
    settings = obj.lamina_dust
    column = split(layout.column())
    _draw_options(column, settings, "stay")
    column.prop(settings, "stops")


def _draw_to(context, layout, obj):
    settings = obj.lamina_dust
    column = split(layout.column())
    column.row().prop(settings, "target", expand=True)
    if settings.target == "image":
        column.prop(settings, "size")
        draw_uv_map(context, column, settings, obj)
        column.operator("lamina.dust_image", text="Unwrap If Needed", icon="UV")
    _draw_options(column, settings, "to")
    column.prop(settings, "seed")


_DRAWN = {"amount": _draw_amount, "from": _draw_from, "stay": _draw_stay, "to": _draw_to}


def _draw_options(column, settings, group):
    """The options of a group that are not drawn above the fold."""
    for option in OPTIONS:
        if option.group == group and option.name not in ("amount", "grams", *_MAIN):
            row = column.row()
            used = {"patch": settings.coverage < 1.0, "edge": settings.rubbed > 0.0}
            row.active = used.get(option.name, True)
            _draw_option(row, settings, option)


def _draw_option(layout, settings, option):
    layout.prop(settings, option.name, text=option.panel.text or option.panel.label)
