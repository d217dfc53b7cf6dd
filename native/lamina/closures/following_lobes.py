# SPDX-License-Identifier: GPL-3.0-or-later
"""Closures whose width follows the roughness of the base, which is an input of the node group.

The lobe of a rough base is seen through an interface. Refraction stretches the lobe, and facets of the interface widen
the lobe: width^2 = (scale alpha)^2 + least^2, where alpha = roughness^2 is the width of the facets of the base. An id
holds scale and least: "follows/ggx:SCALE:LEAST", or "follows/toon:SCALE:LEAST:LEAN:SIZE:SMOOTH", where size and smooth
are for a width of 1."""

from __future__ import annotations

import math

PREFIX = "follows/"
GGX, TOON = PREFIX + "ggx", PREFIX + "toon"
# A closure of no width has no finite value.
LEAST_WIDTH = 1e-3
# Widths relative to that of the lobe along the normal.
WIDTHS = (0.55, 0.74, 1.0, 1.35, 1.8, 2.5)


def ggx(scale: float, least: float) -> str:
    return f"{GGX}:{_rounded(scale):g}:{_rounded(least):g}"


def toon(scale: float, least: float, lean: float, size: float, smooth: float) -> str:
    return f"{TOON}:{_rounded(scale):g}:{_rounded(least):g}:{lean:g}:{size:g}:{smooth:g}"


def width(scale: float, least: float, roughness: float) -> float:
    """The width, at most 1, at a roughness of the base in [0, 1]."""
    return min(1.0, math.hypot(scale * roughness**2, least))


def at(name: str, roughness: float) -> str:
    """The id of the closure with the width at this roughness; other closures stay as they are."""
    if not name.startswith(PREFIX):
        return name
    family, scale, least, *shape = name.split(":")
    found = max(width(float(scale), float(least), roughness), LEAST_WIDTH)
    if family == GGX:
        return f"ggx:{_rounded(found):g}"
    lean, size, smooth = map(float, shape)
    return f"toon:{lean:g}:{_rounded(min(1.0, size * found)):g}:{_rounded(min(1.0, smooth * found)):g}"


def is_sharp(name: str, roughness: float, least: float) -> bool:
    """True for a closure that follows and is narrower than `least` at this roughness."""
    if not name.startswith(PREFIX):
        return False
    scale, own = map(float, name.split(":")[1:3])
    return width(scale, own, roughness) < least


def as_mirror(name: str, roughness: float) -> str:
    """The id of a mirror with the width of a microfacet closure at this roughness; of other closures, `at`."""
    if not name.startswith(GGX):
        return at(name, roughness)
    scale, least = map(float, name.split(":")[1:3])
    return f"mirror:{_rounded(width(scale, least, roughness)):g}"


def _rounded(value: float) -> float:
    return float(f"{value:.4g}")
