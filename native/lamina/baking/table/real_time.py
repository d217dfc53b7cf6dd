# SPDX-License-Identifier: GPL-3.0-or-later
"""The mixture of a table in the few closures that a real-time engine such as Eevee renders.

Eevee shows Toon, Sheen and Hair closures as Diffuse ones. Therefore all closures of one kind are summed to one closure,
with the same directional albedo at each view. A lobe about the mirror direction is a GGX lobe with the
same albedo and the same height: one of width alpha and albedo w is w / (4 pi alpha^2) high at normal incidence.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, replace

import numpy as np

from ...closures import lobes, shaped_lobes
from ...closures.closure_table import column_albedos, view_cosines
from ...kinds.table import SHAPE, TILT, Strip, is_covered, strips_of
from .lut import Lut

DIFFUSE, GLOSSY, MIRROR = "diffuse", "glossy", "mirror"
TRANSLUCENT, THROUGH, TRANSPARENT, STRAIGHT = "translucent", "through", "transparent", "straight"
KINDS = (DIFFUSE, GLOSSY, MIRROR, TRANSLUCENT, THROUGH, TRANSPARENT, STRAIGHT)
# Narrower lobes are mirrors, wider ones are diffuse or translucent: a cosine is as high as a GGX lobe of width 1/2.
NARROWEST, WIDEST = 0.04, 0.5
# Transmitted lobes from this width on are translucent: their tails are wider than those of a GGX lobe.
WIDEST_THROUGH = 0.15
LEAST_ALPHA = 1e-3
ANISOTROPIC = "ShaderNodeBsdfAnisotropic"
AS_DIFFUSE = ("ShaderNodeBsdfToon", "ShaderNodeBsdfSheen", "ShaderNodeBsdfHair")


@dataclass(frozen=True)
class RealTimeTable:
    """`strips`: each has one of KINDS in place of the closure, and the role and metal of the table's strips that it
    sums. `texels`: float32, shape (sides, strips, rows, 64 columns, 4): albedo R G B, and the Roughness (root of alpha)
    of the lobe."""

    strips: list[Strip]
    texels: np.ndarray


def few_closures(lut: Lut) -> RealTimeTable:
    """The closures of `lut` in at most one strip per role, metal and kind. Strips without a closure are left out: the
    node group reads them from the table itself. No strips for a Principled base with inputs below an interface: widths
    that follow the roughness cannot be summed to one width."""
    every = strips_of(lut.header)
    members: dict[Strip, list[int]] = {}
    for index, strip in enumerate([] if is_covered(every) else every):
        if strip.is_weight:
            # Of a lobe that moves with the view always the same, so that the nodes stay while a stack is edited
            kind = GLOSSY if shaped_lobes.is_shaped(strip.closure) else kind_of(strip.closure)[0]
            members.setdefault(replace(strip, closure=kind), []).append(index)
    sides, _, rows, columns, _ = lut.weights.shape
    texels = np.zeros((sides, len(members), rows, columns, 4), np.float32)
    for place, group in enumerate(members.values()):
        total, height = np.zeros((sides, rows, columns, 3)), np.zeros((sides, rows, columns))
        widths = []
        for index in group:
            width, albedo = _lobe(lut, every, index)
            light = lut.weights[:, index] * albedo[..., None]
            total += light
            height += light.mean(axis=-1) / width**2
            widths.append(np.mean(width))
        texels[:, place, ..., :3] = total
        texels[:, place, ..., 3] = _roughness(total.mean(axis=-1), height, float(np.mean(widths)))
    return _with_grey_transparency(list(members), texels)


def _lobe(lut: Lut, every: list[Strip], index: int) -> tuple[np.ndarray | float, np.ndarray]:
    """(width alpha, directional albedo) of the closure of one of the strips: of one that moves with the view, [side,
    row, column]."""
    closure = every[index].closure
    if not shaped_lobes.is_shaped(closure):
        return kind_of(closure)[1], _albedo(closure)
    shapes, azimuths = lut.weights[:, every.index(Strip(closure, SHAPE))], None
    if shaped_lobes.is_oriented(closure):
        shapes = np.concatenate([shapes, lut.weights[:, every.index(Strip(closure, TILT)), ..., :2]], axis=-1)
        azimuths = np.linspace(0.0, math.pi, lut.header["axes"]["azimuth"]["count"])
        azimuths = np.repeat(azimuths, shapes.shape[1] // len(azimuths))[:, None]
    return shapes[..., 0].astype(float) ** 2, shaped_lobes.albedos(shapes, view_cosines(), azimuths)


def _kind(alpha: float) -> str:
    """The kind of a reflected lobe of width alpha."""
    return MIRROR if alpha < NARROWEST else GLOSSY if alpha < WIDEST else DIFFUSE


def _with_grey_transparency(strips: list[Strip], texels: np.ndarray) -> RealTimeTable:
    """Eevee makes the color of a Transparent closure grey. The grey part of the unscattered light, the least of the
    channels, stays transparent. The rest becomes a narrow lobe straight on, so that all channels keep their energy."""
    if Strip(TRANSPARENT) not in strips:
        return RealTimeTable(strips, texels)
    unscattered = texels[:, strips.index(Strip(TRANSPARENT)), ..., :3]
    grey = unscattered.min(axis=-1, keepdims=True)
    if np.all(unscattered == grey):
        return RealTimeTable(strips, texels)
    colored = np.full((*texels[:, 0].shape[:-1], 4), math.sqrt(LEAST_ALPHA), np.float32)
    colored[..., :3] = unscattered - grey
    unscattered[...] = grey
    return RealTimeTable([*strips, Strip(STRAIGHT)], np.concatenate([texels, colored[:, None]], axis=1))


def _roughness(total: np.ndarray, height: np.ndarray, mean: float) -> np.ndarray:
    """Roughness of the lobe of albedo `total` and of `height` (times 4 pi); where there is no light, that of the width
    `mean`."""
    alpha = np.sqrt(np.divide(total, height, out=np.full(total.shape, mean**2), where=height > 0.0))
    return np.sqrt(np.minimum(alpha, 1.0))


@functools.lru_cache(maxsize=256)
def kind_of(closure: str) -> tuple[str, float]:
    """The kind of a closure, one of KINDS, and the width alpha of the GGX lobe that is as high at normal incidence."""
    if closure == TRANSPARENT:
        return TRANSPARENT, LEAST_ALPHA
    node = lobes.recipe(closure)
    if node.type == "ShaderNodeBsdfTranslucent":
        return TRANSLUCENT, WIDEST
    if node.type == "ShaderNodeBsdfHair":
        alpha = _as_high(closure)
        return (THROUGH if alpha < WIDEST_THROUGH else TRANSLUCENT), alpha
    if node.type == "ShaderNodeBsdfPrincipled" or closure.startswith("mirror:"):
        roughness = node.inputs["Roughness"]
        assert isinstance(roughness, float | int)
        alpha = max(roughness**2, LEAST_ALPHA)
    elif node.type == ANISOTROPIC or node.enums.get("component") == "GLOSSY" or node.normal[0] == "lean":
        alpha = _as_high(closure)
    else:
        return DIFFUSE, WIDEST
    return _kind(alpha), alpha


def shown_as_diffuse(closure: str) -> float:
    """Mean albedo, over views with the weight of their cosine, of a closure that Eevee shows as a Diffuse one of albedo
    1; 1 for others."""
    if lobes.recipe(closure).type not in AS_DIFFUSE:
        return 1.0
    cosines = view_cosines()
    return float(np.average(_albedo(closure), weights=cosines * np.sqrt(1.0 - cosines**2)))  # uniform in the angle


def _as_high(closure: str) -> float:
    """Width of the GGX lobe of the same height relative to its albedo, at normal incidence."""
    highest = float(lobes.by_id(closure).evaluate(1.0, 1.0, 0.0))
    return math.sqrt(_albedo(closure)[0] / (4.0 * math.pi * highest))


@functools.lru_cache(maxsize=256)
def _albedo(closure: str) -> np.ndarray:
    """Directional albedo of the closure at the table's columns, shape (64,). Mirrors, unscattered light and lobes
    that stray beyond the horizon keep all."""
    if closure == TRANSPARENT or closure.startswith("mirror:") or lobes.by_id(closure).strays:
        return np.ones(len(view_cosines()))
    return column_albedos((closure,))[:, 0]
