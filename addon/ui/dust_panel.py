# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of the dust on the active object, below the layers of its material."""

import bpy

from ..base.messages import RefusedError
from ..kinds.dust import GROUPS, OPTIONS
from ..nodes import dust_strength, thickness
from ..settling import dust_frames, dust_job, dust_settings, live_dust, object_dust
from .fields import split
from .material_panel import MaterialPanel
from .sentences import draw_progress, draw_sentence
from .uv_map_field import draw_uv_map

BACK_MATTERS = 0.05  # share of the largest thickness


class LAMINA_PT_dust(MaterialPanel, bpy.types.Panel):
    bl_label = "Settled Dust"
    bl_parent_id = "LAMINA_PT_main"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return super().poll(context) and context.object is not None

    def draw(self, context):
        layout, obj = self.layout, context.object
        sentence = object_dust.problem(obj)
        if sentence:
            draw_sentence(context, layout, sentence, "ERROR" if object_dust.unavailable() else "INFO")
            return
        settings, strength = obj.lamina_dust, dust_strength.socket()
        if strength is not None:
            split(layout.column()).prop(strength, "default_value", text="Strength of All Dust")
        for name, heading, folded in GROUPS:
            header, body = layout.panel(f"lamina_dust_{name}", default_closed=folded)
            header.label(text=heading)
            if body is not None:
                _DRAWN[name](context, body, obj)
        sentence = object_dust.advice(obj, obj.evaluated_get(context.evaluated_depsgraph_get()))
        if sentence:
            draw_sentence(context, layout, sentence, "INFO")
            layout.operator("lamina.dust_image", icon="IMAGE_DATA")
        job = dust_job.running()
        if job is not None:
            draw_progress(layout, job, "DUST")
            return
        row = layout.row(align=True)
        row.scale_y = 1.4
        text = "Settle Again" if settings.told else "Settle Dust"
        row.operator("lamina.dust_settle", text=text, icon="FORCE_FORCE")
        row.prop(settings, "live", toggle=True, icon="PAUSE" if settings.live else "PLAY")
        if settings.told:
            row.operator("lamina.dust_clear", text="", icon="TRASH")
        if live_dust.failure(obj):
            draw_sentence(context, layout, live_dust.failure(obj), "ERROR", alert=True)
        if settings.told:
            if dust_settings.is_outdated(settings) and not live_dust.is_pending(obj):
                text = "Only a preview" if settings.settled == object_dust.PARTLY else "Out of date"
                draw_sentence(context, layout, f"{text}: Settle Again uses all settings", "FILE_REFRESH")
            draw_sentence(context, layout, settings.told[0].upper() + settings.told[1:])
            sentence = mismatch(context.material, settings)
            if sentence:
                draw_sentence(context, layout, sentence, "ERROR")


def mismatch(material, settings):
    """The reason why the material does not show the dust correctly, or ''."""
    found = thickness.wiring(material)
    if found.source == "none":
        return "The material has no thickness input: mark its dust layer as varying"
    if found.source != settings.target:
        return f"The material does not read it: its thickness comes from {found.source} {found.name}".rstrip()
    most = material.lamina.node_group.get("lamina_largest_tau", -1.0)
    if 0.0 <= most < settings.largest:
        return (f"Thicker than baked: above thickness {most:.3g} nothing changes. "
                "Raise the layer's thickness and bake")
    if settings.largest_back > BACK_MATTERS * settings.largest and not material.lamina.node_group.get(
            "lamina_shows_back", True):
        return ("Dust on back faces is not shown: this sheet has two different sides, and its dust layer is "
                "that of the front. Flip the normals of faces that look down")
    return ""


def _draw_amount(context, layout, obj):
    settings = obj.lamina_dust
    layout.row().prop(settings, "form", expand=True)
    column = split(layout.column())
    unused = "amount" if settings.form == "mass" else "grams"
    for option in _options("amount"):
        if option.name != unused:
            _draw_option(column, settings, option)
        if option.name == "grams" != unused:
            column.prop(settings, "substance")
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
    for option in _options("from"):
        _draw_option(column, settings, option)
    column.prop(settings, "wind")
    row = column.row()
    row.active = settings.wind > 0.0
    row.prop(settings, "wind_from")
    column.prop(settings, "others")


def _draw_stay(_context, layout, obj):
    settings = obj.lamina_dust
    column = split(layout.column())
    for option in _options("stay"):
        row = column.row()
        row.active = option.name != "patch" or settings.coverage < 1.0
        _draw_option(row, settings, option)
    column.prop(settings, "stops")


def _draw_to(context, layout, obj):
    settings = obj.lamina_dust
    column = split(layout.column())
    column.row().prop(settings, "target", expand=True)
    if settings.target == "image":
        column.prop(settings, "size")
        draw_uv_map(context, column, settings, obj)
        column.operator("lamina.dust_image", text="Unwrap If Needed", icon="UV")
    for option in _options("to"):
        _draw_option(column, settings, option)
    column.prop(settings, "seed")


_DRAWN = {"amount": _draw_amount, "from": _draw_from, "stay": _draw_stay, "to": _draw_to}


def _options(group):
    return [option for option in OPTIONS if option.group == group]


def _draw_option(layout, settings, option):
    layout.prop(settings, option.name, text=option.panel.text or option.panel.label)


register, unregister = bpy.utils.register_classes_factory((LAMINA_PT_dust,))
