# SPDX-License-Identifier: GPL-3.0-or-later
"""The result of a bake as pictures: a ball, lobes of three views, and the albedo over the view angle.

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
BALL = 3.5  # units
LEGEND = "Blue: exact. Outline: as rendered"

_pictures = None  # Blender's collection of previews, while the add-on is registered
_shown = {}  # (material's session_uid, kind) -> (text of curves, ink, size, views, names in the collection)
_serial = 0


def draw_ball(layout, context, material):
    """Draw the ball in a studio; returns False, with nothing drawn, if there is none."""
    zoom = context.preferences.system.ui_scale
    found = _drawn(material, _ink(context), round(BALL * UNIT * zoom), "ball")
    if found is not None:
        layout.template_icon(_pictures[found[1][-1]].icon_id, scale=BALL)
    return found is not None


def draw(layout, context, material):
    """Draw the lobes and the albedo; returns False, with nothing drawn, if there are none."""
    zoom = context.preferences.system.ui_scale
    units = (context.region.width / zoom / UNIT - BORDERS) / 3.0
    scale = math.floor(STEPS * min(max(units, LEAST_UNITS), MOST_UNITS)) / STEPS
    found = _drawn(material, _ink(context), round(scale * UNIT * zoom), "lobes")
    if found is None:
        return False
    views, names = found
    row = layout.row(align=True)
    for view, name in zip(views, names, strict=False):
        _draw_one(row, name, f"View {view:.0f}°", scale)
    _centered(layout, LEGEND)
    _draw_one(layout, names[-1], "Reflectance, 0° to 90°", scale)
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


def _drawn(material, ink, size, kind):
    """(view angles, names of pictures): of "ball", or of "lobes" and the albedo; None without curves."""
    text, key = material.lamina.result.curves, (material.session_uid, kind)
    known = _shown.get(key)
    if known is None or known[:3] != (text, ink, size):
        living = {one.session_uid for one in bpy.data.materials}
        for old in [old for old in _shown if old == key or old[0] not in living]:
            _forget(old)
        known = _shown[key] = (text, ink, size, *_new(text, ink, size, kind))
    return known[3:] if known[4] else None


def _new(text, ink, size, kind):
    """Draw the pictures of curves: (view angles, names). Nothing for a text that holds no curves."""
    if not text or not native.available():
        return [], []
    pixels = native.part("baking.report.result_picture")
    try:
        curves = json.loads(text)
        if kind == "ball":
            made = [pixels.ball_picture(curves, size, ink)]
        else:
            made = [pixels.lobe_picture(curves, view, size, ink) for view in range(len(curves["views"]))]
            made.append(pixels.albedo_picture(curves, size, ink))
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


def _forget(key):
    for name in _shown.pop(key)[4]:
        del _pictures[name]


def register():
    global _pictures
    _pictures = bpy.utils.previews.new()


def unregister():
    global _pictures
    bpy.utils.previews.remove(_pictures)
    _pictures = None
    _shown.clear()
