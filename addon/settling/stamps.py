# SPDX-License-Identifier: GPL-3.0-or-later
"""Brushes that wipe: a plain one, finger marks, and the streaks of a cloth.

Each is a brush of this file with a texture, so an artist can change it, and the brushes that come with
Blender stay as they are."""

import math
from typing import NamedTuple

import bpy
import numpy as np

from ..base import data_image
from ..base.messages import RefusedError

MARK = "lamina_stamp"  # of a brush: the key of its stamp
SIDE = 256  # of a stamp's image
# {mode of the context: (mode of a brush, settings of the tool, switch of a brush for this mode)}
_MODES = {"PAINT_VERTEX": ("VERTEX_PAINT", "vertex_paint", "use_paint_vertex"),
          "PAINT_TEXTURE": ("TEXTURE_PAINT", "image_paint", "use_paint_image")}  # fmt: skip
_RIDGES = 11.0  # across a finger mark
_FOLDS = 72  # of the cloth, across a streak


def _plain(x, y):
    return np.ones_like(x)


def _finger_mark(x, y):
    """Ridges that bend around the middle of an ellipse."""
    away = np.hypot(x / 0.68, y / 0.95)
    bent = np.hypot(x, 0.55 * (y + 0.25)) + 0.06 * np.sin(5.0 * y + 2.0 * x)
    ridges = np.clip(0.5 + 1.6 * np.cos(2.0 * math.pi * _RIDGES * bent), 0.0, 1.0)
    pressed = np.clip((1.0 - away) / 0.2, 0.0, 1.0)
    return pressed * (0.25 + 0.75 * ridges)


def _streaks(x, y):
    """Folds of a cloth that wipes along y: lines of different strengths. Blender turns y along the stroke."""
    strengths = np.random.default_rng(7).beta(0.7, 0.9, _FOLDS)
    across = np.interp(x, np.linspace(-1.0, 1.0, _FOLDS), strengths)
    inside = np.clip(2.0 * (1.0 - np.abs(x)), 0.0, 1.0) * np.clip(2.5 * (1.0 - np.abs(y)), 0.0, 1.0)
    return across * inside


class Stamp(NamedTuple):
    """shape(x, y) in [0, 1] of coordinates in [-1, 1]. spacing: between stamps of a stroke, in per cent of
    the brush. turns: the name of the texture slot's switch for its angle, or None."""

    name: str
    description: str
    shape: callable
    spacing: int
    turns: str | None = None

    def texels(self):
        """(SIDE, SIDE, 4): white, with the shape as alpha, since black would bring the layer back."""
        step = (np.arange(SIDE) + 0.5) * 2.0 / SIDE - 1.0
        texels = np.ones((SIDE, SIDE, 4), np.float32)
        texels[..., 3] = self.shape(*np.meshgrid(step, step))
        return texels


STAMPS = {
    "PLAIN": Stamp("Stroke", "Wipe with a plain round brush", _plain, 10),
    "FINGER": Stamp(
        "Finger Marks", "Each click leaves a finger mark, turned at random", _finger_mark, 130, "use_random"),
    "STREAKS": Stamp(
        "Streaks", "Wipe with a cloth, which leaves streaks along the stroke", _streaks, 12, "use_rake"),
}  # fmt: skip


def is_painting(context):
    return context.mode in _MODES


def chosen(context):
    """The key of the stamp of the active brush, or ""."""
    brush = _paint(context).brush if is_painting(context) else None
    return "" if brush is None else brush.get(MARK, "")


def choose(context, key):
    """Paint with a stamp. Raises RefusedError outside of paint mode."""
    if not is_painting(context):
        raise RefusedError("Stamps need paint mode: click Wipe by Hand first")
    mode, _settings, use = _MODES[context.mode]
    ours = (one for one in bpy.data.brushes if one.library is None and one.get(MARK) == key)
    brush = next((one for one in ours if getattr(one, use)), None)
    _activate(_paint(context), _new(key, mode) if brush is None else brush)


def _paint(context):
    return getattr(context.tool_settings, _MODES[context.mode][1])


def _new(key, mode):
    stamp = STAMPS[key]
    name = f"Wipe: {stamp.name}"
    brush = bpy.data.brushes.new(name, mode=mode)
    brush[MARK] = key
    brush.color = (1.0, 1.0, 1.0)
    brush.stroke_method, brush.spacing = "SPACE", stamp.spacing
    if stamp.shape is _plain:
        return brush
    texture = bpy.data.textures.get(name) or bpy.data.textures.new(name, "IMAGE")
    if texture.image is None:
        texture.image = data_image.create(name, stamp.texels())
    texture.extension = "CLIP"
    brush.texture = texture
    slot = brush.texture_slot
    slot.map_mode = "VIEW_PLANE"
    setattr(slot, stamp.turns, True)
    if stamp.turns == "use_random":
        slot.random_angle = 2.0 * math.pi
    return brush


def _activate(paint, brush):
    """Let `paint` use a brush of this file. In later Blenders only this operator changes the active brush."""
    try:
        paint.brush = brush
    except AttributeError:
        brush.asset_mark()
        name = f"Brush/{brush.name}"
        bpy.ops.brush.asset_activate(asset_library_type="LOCAL", relative_asset_identifier=name)
