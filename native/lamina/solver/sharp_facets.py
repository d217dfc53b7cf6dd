# SPDX-License-Identifier: GPL-3.0-or-later
"""Facets narrower than alpha .03, which a bake solves as mirrors: their lobes need many azimuth orders.

Between boundaries a mirror is too bright. Light near the critical angle that facets deflect is reflected totally, and
meets the facets again. The mean over azimuths alone tells how much light is lost there, for facets of any width."""

from __future__ import annotations

from dataclasses import replace

from ..kinds.bases import LEAST_ALPHA, Conductor, PrincipledBase
from ..kinds.boundaries import Interface
from ..material.stack import Stack

GLOSSY = Conductor | PrincipledBase


def is_sharp(surface) -> bool:
    """True for facets that can be solved, and that a bake solves as a mirror."""
    return isinstance(surface, Interface | Conductor) and 0.0 < surface.alpha < LEAST_ALPHA


def as_mirrors(stack: Stack) -> Stack:
    """The stack with smooth boundaries and metals in place of those with sharp facets."""
    if not any(map(is_sharp, (*stack.layers, stack.base))):
        return stack
    return stack.with_facets([_smoothed(layer) for layer in stack.layers], _smoothed(stack.base))


def lose_light(stack: Stack, shown: Stack) -> bool:
    """True if `stack` has sharp facets that are mirrors in `shown`, and another boundary, so that it may reflect less
    light. Only stacks on an opaque base count."""
    interfaces = sum(isinstance(layer, Interface) for layer in stack.layers)
    if interfaces + isinstance(stack.base, GLOSSY) < 2 or stack.base is None:
        return False
    base = stack.base
    return shown is not stack or (isinstance(base, PrincipledBase) and 0.0 < base.roughness**2 < LEAST_ALPHA)


def _smoothed(surface):
    return replace(surface, alpha=0.0) if is_sharp(surface) else surface
