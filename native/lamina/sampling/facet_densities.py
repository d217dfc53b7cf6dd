# SPDX-License-Identifier: GPL-3.0-or-later
"""The density of the facet normals of rough boundaries inside a stack, by directions in air."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..kinds.bases import Retroreflector
from ..kinds.boundaries import Interface
from ..material.stack import Stack


@dataclass(frozen=True)
class FacetDensity:
    """Facets of width `alpha`, GGX or Beckmann. `near`: the index where the view's light leaves the facets; `far`: the
    index where the light arrives, negative on the other side of the boundary. `retro`: the facets send light back."""

    alpha: float
    is_ggx: bool
    near: float
    far: float
    retro: bool = False

    def at(self, sine2_o, sine2_i, across2, xp):
        """Density per solid angle. `sine2_o`, `sine2_i`: squared sines of both angles in air; `across2`: the squared
        sum of both directions along the surface, which refraction keeps; `xp`: the module of sqrt, exp and maximum."""
        if self.retro:
            across2 = 2.0 * (sine2_o + sine2_i) - across2
        along = (xp.sqrt(xp.maximum(self.near**2 - sine2_o, 0.0))
                 + math.copysign(1.0, self.far) * xp.sqrt(xp.maximum(self.far**2 - sine2_i, 0.0)))
        slope2 = across2 / xp.maximum(along * along, 1e-12)
        width2 = self.alpha**2
        # The fourth power of the normal's cosine.
        steep = (1.0 + slope2) * (1.0 + slope2)
        if self.is_ggx:
            spread = 1.0 + slope2 / width2
            return steep / (math.pi * width2 * spread * spread)
        return steep * xp.exp(-slope2 / width2) / (math.pi * width2)


def summed(densities, sine2_o, sine2_i, across2, xp):
    """The sum of the densities; 0 without facets."""
    total = 0.0 * across2
    for one in densities:
        total = total + one.at(sine2_o, sine2_i, across2, xp)
    return total


def densities_of(stack: Stack, side: str, path: str) -> tuple[FacetDensity, ...]:
    """The rough boundaries whose facets a view sees, by their first channel."""
    found, above = [], 1.0
    for layer in stack.layers:
        if isinstance(layer, Interface):
            below = _first(layer.ior)
            if _first(layer.alpha) > 0.0 and (path == "reflect" or above != below):
                near, far = (above, below) if side == "top" else (below, above)
                found.append(FacetDensity(_first(layer.alpha), layer.distribution == "ggx", near,
                                          near if path == "reflect" else -far))
            above = below
    base = stack.base
    alpha = _first(getattr(base, "alpha", 0.0))
    if alpha > 0.0:
        found.append(FacetDensity(alpha, getattr(base, "distribution", "ggx") == "ggx", above, above,
                                  isinstance(base, Retroreflector)))
    return tuple(found)


def _first(value) -> float:
    return float(np.ravel(value)[0])
