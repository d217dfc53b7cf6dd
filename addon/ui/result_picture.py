# SPDX-License-Identifier: GPL-3.0-or-later
"""The result of a bake as pictures: lobes of three views, the albedo over the view angle, and a ball.

The material keeps the curves; the pixels are drawn again for each session and for each color of the theme's
text, so that the pictures are readable in dark and light themes and add nothing to the file's images."""

import json
import math

import bpy
import bpy.utils.previews

from ..base import native

UNIT = 20.0  # pixels of a unit of Blender's layouts, at scale 1
LEAST_UNITS, MOST_UNITS = 3.0, 7.0  # size of a picture in a narrow and in a wide editor
BORDERS = 2.5  # units of an editor's width that panels do not use
STEPS = 4.0  # sizes per unit: pictures are drawn again for each size
LEGEND = "Blue: exact. Outline: as rendered"

_pictures = None  # Blender's collection of previews, while the add-on is registered
_shown = {}  # material's session_uid -> (text of the curves, ink, size, views, names in the collection)
_serial = 0


def draw(layout, context, material):
    """Draw the pictures; returns False, with nothing drawn, if there are none."""
    zoom = context.preferences.system.ui_scale
    units = (context.region.width / zoom / UNIT - BORDERS) / 3.0
    scale = math.floor(STEPS * min(max(units, LEAST_UNITS), MOST_UNITS)) / STEPS
    found = _drawn(material, _ink(context), round(scale * UNIT * zoom))
    if found is None:
        return False
    views, names = found
    row = layout.row(align=True)
    for view, name in zip(views, names, strict=False):
        _draw_one(row, name, f"View {view:.0f}°", scale)
    _centered(layout, LEGEND)
    row = layout.row(align=True)
    _draw_one(row, names[-2], "Reflectance, 0° to 90°", scale)
    _draw_one(row, names[-1], "Under a White Sky", scale)
    return True


def _draw_one(row, name, text, scale):
    column = row.column(align=True)
    column.template_icon(_pictures[name].icon_id, scale=scale)
    _centered(column, text)


def _centered(layout, text):
    row = layout.row()
    row.alignment = "CENTER"
    row.label(text=text)


def _ink(context):
    """The color of the theme's text."""
    return tuple(context.preferences.themes[0].user_interface.wcol_regular.text)[:3]


def _drawn(material, ink, size):
    """(view angles, names of pictures): lobes, then the albedo and the ball; None without curves."""
    text = material.lamina.result.curves
    known = _shown.get(material.session_uid)
    if known is None or known[:3] != (text, ink, size):
        living = {one.session_uid for one in bpy.data.materials}
        for uid in set(_shown) - living | {material.session_uid}:
            _forget(uid)
        known = _shown[material.session_uid] = (text, ink, size, *_new(text, ink, size))
    return known[3:] if known[4] else None


def _new(text, ink, size):
    """Draw the pictures of curves: (view angles, names). Nothing for a text that holds no curves."""
    if not text or not native.available():
        return [], []
    pixels = native.part("baking.report.result_picture")
    try:
        curves = json.loads(text)
        made = [pixels.lobe_picture(curves, view, size, ink) for view in range(len(curves["views"]))]
        made += [pixels.albedo_picture(curves, size, ink), pixels.ball_picture(curves, size, ink)]
    except (ValueError, KeyError, TypeError, IndexError):  # made by another version
        return [], []
    return curves["views"], [_add(picture) for picture in made]


def _add(picture):
    global _serial
    _serial += 1
    name = str(_serial)
    preview = _pictures.new(name)
    preview.image_size = picture.shape[1], picture.shape[0]
    picture[..., :3] *= picture[..., 3:]  # icons have colors multiplied by alpha
    preview.image_pixels_float = picture.ravel().tolist()  # foreach_set would change a copy
    return name


def _forget(uid):
    if uid in _shown:
        for name in _shown.pop(uid)[4]:
            del _pictures[name]


def register():
    global _pictures
    _pictures = bpy.utils.previews.new()


def unregister():
    global _pictures
    bpy.utils.previews.remove(_pictures)
    _pictures = None
    _shown.clear()
