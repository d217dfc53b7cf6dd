# SPDX-License-Identifier: GPL-3.0-or-later
"""Facets narrower than alpha .03, which a bake solves as mirrors: their lobes need many azimuth orders. So do rough
boundaries between two mirrors that refract light into lobes as narrow as such facets do, see narrowed.

A mirror reflects another share of the light than such facets. At grazing views the facets reflect less, because many of
them face the light more steeply: a third at a cosine of .05 and alpha .03. Between boundaries light that facets deflect
beyond the critical angle is reflected totally, and meets the facets again. The mean over azimuths alone tells how much
light facets of any width reflect. A measured peak that is narrower is solved as wide as .03, with its own flux."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..kinds.bases import LEAST_ALPHA, Conductor, Measured, PrincipledBase
from ..kinds.boundaries import Interface
from ..kinds.fields import mean
from ..material import half_table
from ..material.stack import Stack
from ..material.stack_checks import Base, Layer
from .core_stack import core_base


def is_sharp(surface) -> bool:
    """True for facets that can be solved, and that a bake solves as a mirror; and for a measured peak as narrow."""
    if isinstance(surface, Measured):
        return peak_alpha(surface) < LEAST_ALPHA
    return isinstance(surface, Interface | Conductor) and 0.0 < surface.alpha < LEAST_ALPHA


def narrowed(layers: Sequence[Layer], base: Base | None) -> list[Layer]:
    """The layers of a stack, with narrower facets at each rough boundary between two mirrors that refracts light into
    lobes no wider than facets of alpha .03 between 1 and 1.5 do. Light crosses such a boundary again and again, which
    takes too many azimuth orders. Reflection by the new facets is as wide as two refractions by the old ones; the
    little light that the old ones reflect is too narrow."""
    found, above = list(layers), 1.0
    mirrors, rough = [], {}
    for number, layer in enumerate(layers):
        if isinstance(layer, Interface):
            below = mean(layer.ior)
            if below == above:
                continue
            width = abs(below - above) * layer.alpha
            if layer.alpha < LEAST_ALPHA:
                mirrors.append(number)
            elif width < 0.5 * LEAST_ALPHA and layer.alpha_v is None:
                rough[number] = replace(layer, alpha=width / (math.sqrt(2.0) * above))
            above = below
    if isinstance(base, Conductor) and base.alpha < LEAST_ALPHA:
        mirrors.append(len(found))
    for number, layer in rough.items():
        if mirrors and mirrors[0] < number < mirrors[-1]:
            found[number] = layer
    return found


def as_mirrors(stack: Stack) -> Stack:
    """The stack with smooth boundaries and metals in place of those with sharp facets."""
    layers = narrowed(stack.layers, stack.base)
    if not any(map(is_sharp, (*layers, stack.base))):
        return stack
    return stack.with_facets([_smoothed(layer) for layer in layers], _smoothed(stack.base))


def has_sharp_facets(stack: Stack, shown: Stack) -> bool:
    """True if `stack`, on an opaque base, has sharp facets that are solved as mirrors in `shown`."""
    base = stack.base
    if base is None:
        return False
    return shown is not stack or (isinstance(base, PrincipledBase) and 0.0 < base.roughness**2 < LEAST_ALPHA)


def take_lost(scattered, mirrored, lost):
    """(scattered, mirrored): shares of flux less `lost`, see ScatteringFunction.lost_by_facets. Facets below an
    absorbing layer may lose more than the mirrored light; the rest is taken from the scattered light. Arrays of one
    shape."""
    kept = np.maximum(mirrored - lost, 0.0)
    return np.maximum(scattered - np.maximum(lost - mirrored, 0.0), 0.0), kept


def peak_alpha(base: Measured) -> float:
    """The width of facets whose lobe is as wide as the narrowest peak of any channel."""
    return min(core_base(base.in_channel(channel)).alpha for channel in range(base.channels))


@functools.lru_cache(maxsize=4)
def _widened(base: Measured) -> Measured:
    table = half_table.widened(half_table.table_in(base.table), peak_alpha(base), LEAST_ALPHA)
    return replace(base, table=half_table.text_from(table))


def _smoothed(surface):
    if isinstance(surface, Measured):
        return _widened(surface) if is_sharp(surface) else surface
    return replace(surface, alpha=0.0) if is_sharp(surface) else surface
