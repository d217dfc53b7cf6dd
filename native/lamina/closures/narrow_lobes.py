# SPDX-License-Identifier: GPL-3.0-or-later
"""Narrow lobes of a stack: which there are, and the closures made to measure for them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ..kinds.bases import Conductor
from ..kinds.boundaries import Interface
from ..kinds.fields import channel
from ..material.stack import Stack

# Facets narrower than this reflect and refract like a mirror to the solver; only their closure is as wide as
# they are. What is neglected is a share of alpha^2.
LEAST_ALPHA = 0.03
# From here on, the light grid made for smooth slices holds a lobe as well.
BROAD_ALPHA = 0.45
# Of what forward scattering sends through a sheet.
STRAIGHT_ALPHA = 0.2
# Widths of closures for lobes whose own is unknown follow each other by this factor.
STEP = 1.35
# Seen through a refracting boundary or an absorbing layer a lobe leans from the mirror direction towards the normal:
# cones that lean by these shares, of (size, smooth) for a lobe of alpha 1.
LEANS = (0.0, 0.1, 0.2, 0.35, 0.6, 1.0)
AWAY = (-0.2, -0.05, 0.1)
CONES = ((0.07, 0.4), (0.17, 0.67), (0.17, 1.0), (0.33, 1.33))


def resolved(stack: Stack) -> Stack:
    """The stack as it is solved for a bake: facets too narrow for any table are a smooth boundary."""
    layers = [replace(layer, alpha=0.0) if _is_sharp(layer) else layer for layer in stack.layers]
    base = replace(stack.base, alpha=0.0) if _is_sharp(stack.base) else stack.base
    return stack.with_facets(layers, base)


def narrowest(stack: Stack) -> float | None:
    """Alpha of the narrowest lobe that a table must hold, or None."""
    widths = [surface.alpha for surface, _, _ in _rough(stack)]
    if stack.base is None:
        widths.append(STRAIGHT_ALPHA)
    if not widths:
        return None
    # Light that passes a rough boundary, is mirrored and passes it again is turned less than by reflection.
    return min(widths) * (_refracted_share(stack) if _sees_through(stack) else 1.0)


def closures(stack) -> list[str]:
    """Ids of closures for the lobes of a stack, of all boundaries of `resolved(stack)` that are rough."""
    ids: list[str] = []
    rough = _rough(stack)
    for surface, above, below in rough:
        ids.append(_id(surface.distribution, surface.alpha))
        # F as a function of the half angle. For a dielectric's GGX facets F0 ggx + (1 - F0) fresnel_ggx is exact; for
        # metals and Beckmann's facets its shape serves.
        index = below / above if isinstance(surface, Interface) else 1.5
        widths = (1.0,) if surface.distribution == "ggx" else (0.9, 1.6)
        ids += [f"fresnel_ggx:{max(index, 1.0 / index):.4g}:{_rounded(min(1.0, surface.alpha * w)):g}" for w in widths]
        if surface.distribution == "beckmann":
            ids += [_id("beckmann", 0.9 * surface.alpha), f"fresnel_ggx:1.1:{_rounded(0.9 * surface.alpha):g}"]
            # At grazing Fresnel's factor moves the lobe past the mirror direction, and no tail hides that.
            ids += [_cone(lean, min(1.0, w * surface.alpha * size), min(1.0, w * surface.alpha * smooth))
                    for lean in AWAY for w in (1.0, 2.0) for size, smooth in CONES]
    if rough and (_covered(stack) or len(rough) > 1 or _sees_through(stack)):
        widest = max(surface.alpha * above for surface, above, _ in rough) * STEP
        alpha = narrowest(stack)
        while alpha < min(1.0, widest) * STEP:
            ids.append(_id("ggx", min(alpha, 1.0)))
            alpha *= STEP
        for width in sorted({_rounded(widest / STEP), _rounded(max(narrowest(stack), 0.3 * widest))}):
            ids += [_cone(lean, min(1.0, width * size), min(1.0, width * smooth)) for lean in LEANS
                    for size, smooth in CONES]
    return list(dict.fromkeys(ids))


def mirror(stack: Stack) -> str:
    """Id of the closure for what the smooth boundaries of `resolved(stack)` reflect: as wide as the widest of
    those facets that are solved as smooth, seen through the media above."""
    widths = [0.0]
    above = 1.0
    for surface in (*stack.layers, stack.base):
        if _is_sharp(surface):
            widths.append(surface.alpha * above)
        if isinstance(surface, Interface):
            above = _mean(surface.ior)
    return f"mirror:{_rounded(max(widths)):g}"


def _is_sharp(surface) -> bool:
    return isinstance(surface, Interface | Conductor) and 0.0 < surface.alpha < LEAST_ALPHA


def _rough(stack: Stack) -> list[tuple[Interface | Conductor, float, float]]:
    """(surface, index above, index below) of the boundaries that are solved as rough."""
    found, above = [], 1.0
    for layer in stack.layers:
        if isinstance(layer, Interface):
            below = _mean(layer.ior)
            if layer.alpha >= LEAST_ALPHA and below != above:
                found.append((layer, above, below))
            above = below
    if isinstance(stack.base, Conductor) and stack.base.alpha >= LEAST_ALPHA:
        found.append((stack.base, above, above))
    return found


def _covered(stack: Stack) -> bool:
    """Whether anything lies above a rough boundary."""
    surfaces = [*stack.layers, stack.base]
    return any(isinstance(surface, Interface | Conductor) and surface.alpha >= LEAST_ALPHA for surface in surfaces[1:])


def _sees_through(stack: Stack) -> bool:
    """Whether something that mirrors or glosses lies beneath a rough dielectric boundary."""
    surfaces = [surface for surface in (*stack.layers, stack.base) if isinstance(surface, Interface | Conductor)]
    return any(isinstance(surface, Interface) and surface.alpha >= LEAST_ALPHA for surface in surfaces[:-1])


def _refracted_share(stack: Stack) -> float:
    """Least share of a facet's slope by which it turns refracted light, against twice the slope in reflection."""
    shares = [abs(below - above) / max(above, below) for surface, above, below in _rough(stack) if above != below]
    return min(1.0, math.sqrt(0.5) * min(shares, default=1.0))


def _mean(value) -> float:
    """A quantity's mean over channels: one closure serves all three."""
    return value if isinstance(value, int | float) else float(np.mean([channel(value, c) for c in range(len(value))]))


def _rounded(alpha: float) -> float:
    return float(f"{alpha:.4g}")


def _cone(lean: float, size: float, smooth: float) -> str:
    return f"toon:{lean:g}:{size:.3g}:{smooth:.3g}"


def _id(distribution: str, alpha: float) -> str:
    return f"{distribution}:{_rounded(alpha):g}"
