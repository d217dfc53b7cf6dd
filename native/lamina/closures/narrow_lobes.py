# SPDX-License-Identifier: GPL-3.0-or-later
"""Narrow lobes of rough boundaries, metals and flakes, halos around mirror images, and the closures made for them."""

from __future__ import annotations

import itertools
import math

import numpy as np

from .. import _core
from ..kinds.bases import LEAST_ALPHA, Conductor, HalfSpace, Measured, PrincipledBase, Retroreflector
from ..kinds.boundaries import Interface
from ..kinds.fibers import Fibers
from ..kinds.fields import mean
from ..kinds.films import Film
from ..kinds.flakes import Flakes
from ..material.layers import Medium
from ..material.stack import Stack
from ..solver.sharp_facets import is_sharp, narrowed, peak_alpha

Rough = Interface | Conductor | PrincipledBase | Retroreflector | Flakes  # they scatter into a lobe unless alpha is 0
# Facets narrower than LEAST_ALPHA are solved as mirrors, and only their closure has their width.
# From this width on, the light grid for smooth slices also resolves a lobe.
BROAD_ALPHA = 0.45
# Width of the lobe of light scattered forward through a sheet.
STRAIGHT_ALPHA = 0.2
# Ratio of the widths of closures for lobes of unknown width.
STEP = 1.35
# Ratio of the widest closure for the lobes of a measured base to its narrowest peak.
WIDER = 8.0
# Through a refracting boundary or an absorbing layer, a lobe is tilted from the mirror direction towards the normal.
# Cones tilted by these shares fit it; (size, smooth) are for a lobe of alpha 1.
LEANS = (0.0, 0.1, 0.2, 0.35, 0.6, 1.0)
AWAY = (-0.2, -0.05, 0.1)
CONES = ((0.07, 0.4), (0.17, 0.67), (0.17, 1.0), (0.33, 1.33))
# Widths of cones about the viewer, relative to those of a retroreflector's lobe along the normal in air. The half width
# of this lobe in radians, over alpha; and the largest half width of a backward peak that counts as narrow.
RETRO_WIDTHS = (0.7, 1.0, 1.5, 2.2, 3.3)
RETRO_HALF, RETRO_REACH = 1.29, 0.4

# A phase function with a smaller 4 pi p straight ahead makes a halo that the dictionary's broad closures hold.
LEAST_FORWARD = 3.0
# Widths of closures for the halo that a medium scatters around the image in a mirror below: those of the half vectors.
HALO_ALPHAS = (0.05, 0.07, 0.1, 0.14, 0.2, 0.28, 0.4, 0.55)


def narrowest(stack: Stack) -> float | None:
    """Alpha of the narrowest lobe that a table must hold, or None."""
    widths = [*(surface.alpha for surface, _, _ in _rough(stack)), *retro_alphas(stack)]
    if stack.base is None:
        widths.append(STRAIGHT_ALPHA)
    if not widths:
        return None
    # Light that crosses a rough boundary, is reflected and crosses the boundary again is deflected less than by
    # reflection.
    return min(widths) * (_refracted_share(stack) if _sees_through(stack) else 1.0)


def closures(stack) -> list[str]:
    """Ids of the closures made for the rough boundaries and flakes of the solved stack."""
    ids: list[str] = []
    rough = _rough(stack)
    for surface, above, below in rough:
        if isinstance(surface, Flakes | Retroreflector):
            continue  # not the law of facets: closures of several widths serve them
        ids.append(_id(surface.distribution, surface.alpha))
        # F as a function of the half angle. For GGX facets of a dielectric, F0 ggx + (1 - F0) fresnel_ggx is exact; for
        # metals and Beckmann facets its shape is a good approximation.
        index = below / above if isinstance(surface, Interface) and below != above else 1.5
        index = surface.ior / above if isinstance(surface, PrincipledBase) else index
        widths = (1.0,) if surface.distribution == "ggx" else (0.9, 1.6)
        ids += [f"fresnel_ggx:{max(index, 1.0 / index):.4g}:{_rounded(min(1.0, surface.alpha * w)):g}" for w in widths]
        if surface.distribution == "beckmann":
            ids += [_id("beckmann", 0.9 * surface.alpha), f"fresnel_ggx:1.1:{_rounded(0.9 * surface.alpha):g}"]
            # At grazing views Fresnel's factor moves the lobe beyond the mirror direction, and a Beckmann lobe has no
            # tail that would hide the shift.
            ids += [_cone(lean, min(1.0, w * surface.alpha * size), min(1.0, w * surface.alpha * smooth))
                    for lean in AWAY for w in (1.0, 2.0) for size, smooth in CONES]
    flaky = any(isinstance(surface, Flakes) for surface, _, _ in rough)
    several = isinstance(stack.base, Measured)  # lobes of unknown widths
    if rough and (_covered(stack) or len(rough) > 1 or _sees_through(stack) or flaky or several):
        widest = max(surface.alpha * above for surface, above, _ in rough) * (WIDER if several else STEP)
        alpha = least = narrowest(stack) or widest
        while alpha < min(1.0, widest) * STEP:
            ids.append(_id("ggx", min(alpha, 1.0)))
            alpha *= STEP
        for width in sorted({_rounded(widest / STEP), _rounded(max(least, 0.3 * widest))}):
            ids += [_cone(lean, min(1.0, width * size), min(1.0, width * smooth)) for lean in LEANS
                    for size, smooth in CONES]
    for alpha in retro_alphas(stack):
        ids += [f"retro:{_rounded(min(1.0, w * alpha * size)):g}:{_rounded(min(1.0, w * alpha * smooth)):g}"
                for w in RETRO_WIDTHS for size, smooth in CONES]
    return list(dict.fromkeys([*ids, *halos(stack)]))


def retro_alphas(stack: Stack) -> list[float]:
    """Widths of the lobes about the viewer: of a retroreflector, and of phase functions with a narrow peak backwards,
    as facets that reflect light along the normal into a lobe of that width."""
    found = [stack.base.alpha] if isinstance(stack.base, Retroreflector) else []
    scattering = [*(layer for layer in stack.layers if isinstance(layer, Medium)), stack.base]
    for medium in scattering:
        if isinstance(medium, Medium | HalfSpace) and not _is_clear(medium):
            angle = np.linspace(0.0, RETRO_REACH, 256)
            phase = _phase(medium).evaluate(-np.cos(angle))
            below = np.flatnonzero(phase < 0.5 * phase[0])
            if below.size and phase[0] >= LEAST_FORWARD:
                found.append(max(LEAST_ALPHA, float(angle[below[0]]) / RETRO_HALF))
    return found


def follow_the_viewer(stack: Stack) -> bool:
    """True if light goes back towards where it came from, in a narrow lobe or, from fibers, in a broad one."""
    return bool(retro_alphas(stack)) or any(isinstance(layer, Fibers) for layer in stack.layers)


def halos(stack: Stack) -> list[str]:
    """Ids of the closures for a halo, none for a stack without one."""
    return [_id("halo", alpha) for alpha in HALO_ALPHAS] if has_halo(stack) else []


def has_halo(stack: Stack) -> bool:
    """True if a medium in air that scatters forward lies above a boundary that is solved as a mirror, seen from the top
    or, of a sheet, from the bottom. A medium below an interface is seen through the interface, so its halo is not
    round."""
    down = [surface for surface, _, _ in _in_order(stack)]
    return _reaches_mirror(down) or (stack.base is None and _reaches_mirror(down[-2::-1]))


def _reaches_mirror(surfaces: list) -> bool:
    media = list(itertools.takewhile(lambda layer: isinstance(layer, Medium), surfaces))
    below = surfaces[len(media)] if len(media) < len(surfaces) else None
    return _is_mirror(below) and any(map(_scatters_forward, media))


def _is_mirror(surface) -> bool:
    if isinstance(surface, PrincipledBase) and "roughness" in surface.inputs:
        return True  # at some values of the input
    return isinstance(surface, Interface | Conductor | PrincipledBase) and surface.alpha < LEAST_ALPHA


def _scatters_forward(medium: Medium) -> bool:
    return not _is_clear(medium) and float(_phase(medium).evaluate(1.0)) >= LEAST_FORWARD


def _phase(medium: Medium | HalfSpace) -> _core.PhaseFunction:
    return _core.PhaseFunction(*medium.phase.in_channel(0))


def _is_clear(medium: Medium | HalfSpace) -> bool:
    """True if a medium scatters no light."""
    given = medium.sigma_s if medium.albedo is None else medium.albedo
    return given is not None and mean(given) == 0.0


def _widths(surface) -> tuple[float, ...]:
    """The widths of the facets of a surface that are solved as mirrors."""
    if isinstance(surface, PrincipledBase):
        own = surface.roughness**2 if surface.alpha == 0.0 else 0.0
        return (own, surface.coat_roughness**2 if surface.coat > 0.0 else 0.0)
    return (surface.alpha,) if is_sharp(surface) else ()


def mirror(stack: Stack) -> str:
    """Id of the closure for light that smooth boundaries of the solved stack reflect. Its width is that of the widest
    facets that are solved as mirrors, seen through the media above."""
    widths = [0.0, *(width * above for surface, above, _ in _in_order(stack) for width in _widths(surface))]
    return f"mirror:{_rounded(max(widths)):g}"


def _in_order(stack: Stack) -> list[tuple]:
    """(layer or base, index above, index below), top first. Thin films are left out, and interfaces without films
    between media of one index. In place of a measured base stands a metal with as narrow a lobe. Rough boundaries
    between mirrors are as they are solved."""
    found, above, filmed = [], 1.0, False
    for layer in narrowed(stack.layers, stack.base):
        if isinstance(layer, Film):
            filmed = True
            continue
        below = mean(layer.ior) if isinstance(layer, Interface) else above
        if not isinstance(layer, Interface) or below != above or filmed:
            found.append((layer, above, below))
        above, filmed = below, False
    base = stack.base
    if isinstance(base, Measured):
        base = Conductor(1.0, 1.0, alpha=max(LEAST_ALPHA, peak_alpha(base)))
    return [*found, (base, above, above)]


def _is_rough(surface) -> bool:
    return isinstance(surface, Rough) and surface.alpha >= LEAST_ALPHA


def _rough(stack: Stack) -> list[tuple[Rough, float, float]]:
    """(surface, index above, index below) of the boundaries that are solved as rough, and of flakes."""
    return [entry for entry in _in_order(stack) if _is_rough(entry[0])]


def _covered(stack: Stack) -> bool:
    """True if anything lies above a rough boundary or flakes."""
    return any(_is_rough(surface) for surface, _, _ in _in_order(stack)[1:])


def _sees_through(stack: Stack) -> bool:
    """True if a smooth or rough reflector lies below a rough dielectric boundary."""
    surfaces = [surface for surface, _, _ in _in_order(stack) if isinstance(surface, Rough)]
    return any(isinstance(surface, Interface) and _is_rough(surface) for surface in surfaces[:-1])


def _refracted_share(stack: Stack) -> float:
    """Smallest deflection of refracted light per slope of a facet, relative to that of reflected light."""
    shares = [abs(below - above) / max(above, below) for surface, above, below in _rough(stack) if above != below]
    return min(1.0, math.sqrt(0.5) * min(shares, default=1.0))


def _rounded(alpha: float) -> float:
    return float(f"{alpha:.4g}")


def _cone(lean: float, size: float, smooth: float) -> str:
    return f"toon:{lean:g}:{size:.3g}:{smooth:.3g}"


def _id(distribution: str, alpha: float) -> str:
    return f"{distribution}:{_rounded(alpha):g}"
