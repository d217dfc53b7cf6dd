# SPDX-License-Identifier: GPL-3.0-or-later
"""A stack as a picture: its layers from the top, each in the colour that an infinitely thick layer would show."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..common import svg
from ..kinds.bases import Conductor, HalfSpace, Lambert, Measured, PrincipledBase, Retroreflector, ShaderBase
from ..kinds.boundaries import Interface, is_oriented
from ..kinds.fibers import Fibers
from ..kinds.fields import Channels, as_channels, channel
from ..kinds.films import Film
from ..kinds.flakes import Flakes
from ..kinds.layers import OrientedLayer
from ..kinds.spectra import Spectrum
from . import half_table
from .colours import shown
from .layers import Medium

if TYPE_CHECKING:
    from .stack import Stack

MIDDLE = 0.7  # cosine at which the picture shows a measured base
WIDTH, TEXT = 150.0, 330.0  # of the picture, and of the words beside it
THIN, THICK, BOUNDARY, BASE = 14.0, 46.0, 4.0, 30.0  # heights in pixels
FILM = "#c060c0"


def stack_picture(stack: Stack) -> str:
    """The SVG of a stack."""
    parts, y = [svg.text(4.0, 16.0, stack.label)], 24.0
    for number, layer in enumerate(stack.layers):
        if isinstance(layer, Interface):
            height, fill = BOUNDARY, "#5090c0"
            words = f"interface, ior {_range(layer.ior, stack)}" + (f", alpha {layer.alpha:g}" if layer.alpha else "")
            words += f" and {layer.alpha_v:g}" if is_oriented(layer) else ""
            words += ", varying" if layer.varying else ""
        elif isinstance(layer, Film):
            height, fill = BOUNDARY, FILM
            words = f"thin film, {layer.thickness:g} nm"
            words += "" if isinstance(layer.ior, Spectrum | complex) else f", ior {_range(layer.ior, stack)}"
        elif isinstance(layer, OrientedLayer):
            height = THIN + (THICK - THIN) * _share(max(stack.optics(number, c)[1] for c in range(stack.channels)))
            is_clear = isinstance(layer, Flakes) and (layer.film or layer.ior is not None)
            fill = FILM if is_clear else _fill(stack, _colour_of_flakes(layer, stack.channels))
            way = f"tilt {layer.tilt:.3g}" if isinstance(layer, Fibers) else f"alpha {layer.alpha:g}"
            words = f"{layer.kind}, tau {_range(layer.tau, stack)}, {way}"
            words += ", varying" if layer.varying else ""
        else:
            taus = [stack.optics(number, c)[1] for c in range(stack.channels)]
            height = THIN + (THICK - THIN) * _share(max(taus))
            fill = _fill(stack, _colour_of(stack, number, layer))
            words = f"medium, tau {_range(as_channels(taus), stack)}" + (", varying" if layer.varying else "")
        name = f"{layer.name}: " if layer.name else ""
        parts += [svg.box(0.0, y, WIDTH, height, fill, "#808080"), svg.text(WIDTH + 8.0, y + 0.5 * height + 4.0,
                                                                           name + words)]
        y += max(height, 16.0 if isinstance(layer, Interface | Film) else THIN)
    if stack.base is None:
        parts.append(svg.text(4.0, y + 16.0, "air"))
    else:
        fill = _fill(stack, _colour_of_base(stack))
        parts += [svg.box(0.0, y, WIDTH, BASE, fill, "#808080"),
                  svg.text(WIDTH + 8.0, y + 0.5 * BASE + 4.0, _words(stack.base))]
    return svg.picture(WIDTH + TEXT, y + BASE + 4.0, parts, f"Stack {stack.label}")


def _words(base) -> str:
    return f"base: {base.kind}" + (f", {base.name}" if isinstance(base, Measured) and base.name else "")


def _fill(stack: Stack, values: list[float]) -> str:
    """The color of an area, from its reflectance in each channel of the stack."""
    if len(values) > 1:
        values = stack.seen(np.array(values)).clip(0.0, 1.0).tolist()
    return svg.colour(values)


def _share(tau: float) -> float:
    """The share of light that is scattered or absorbed along the normal: how thick the layer is drawn."""
    return 1.0 - math.exp(-tau)


def _range(values: Channels, stack: Stack) -> str:
    """One number, or the least and the largest of the channels."""
    numbers = [channel(values, c) for c in range(stack.channels)]
    low, high = min(numbers), max(numbers)
    return f"{low:.3g}" if low == high else f"{low:.3g} to {high:.3g}"


def _colour_of(stack: Stack, number: int, layer: Medium) -> list[float]:
    albedo = as_channels([stack.optics(number, c)[0] for c in range(stack.channels)])
    thick = replace(layer, color=None, over=None, profile=None, sigma_s=None, sigma_a=None, thickness=None,
                    albedo=albedo, tau=math.inf, varying=False)
    return shown(thick.checked("layer"))


def _colour_of_flakes(layer: OrientedLayer, channels: int) -> list[float]:
    if isinstance(layer, Flakes) and layer.eta is not None and layer.k is not None:
        return [_facing(channel(layer.eta, c), channel(layer.k, c)) for c in range(channels)]
    colour = layer.facing if isinstance(layer, Flakes) and layer.reflectance is None else layer.reflectance
    return [channel(colour, c) for c in range(channels)]


def _colour_of_base(stack: Stack) -> list[float]:
    base, channels = stack.base, range(stack.channels)
    if isinstance(base, Lambert | ShaderBase | Retroreflector):
        return [channel(base.reflectance, c) for c in channels]
    if isinstance(base, PrincipledBase):
        return [channel(base.color, c) for c in channels]
    if isinstance(base, Measured):
        return half_table.albedos(half_table.table_in(base.table), np.array([MIDDLE]))[0].tolist()
    if isinstance(base, Conductor):
        return [_facing(*stack.indices(c)) for c in channels]
    if isinstance(base, HalfSpace):
        albedo = as_channels([base.albedo_of(c) for c in channels])
        return shown(Medium(albedo, math.inf, base.phase).checked("base"))
    return [0.0]


def _facing(eta: float, k: float) -> float:
    """Fresnel's reflectance of a metal along the normal."""
    return ((eta - 1.0) ** 2 + k * k) / ((eta + 1.0) ** 2 + k * k)
