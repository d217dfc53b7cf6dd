# SPDX-License-Identifier: GPL-3.0-or-later
"""The factors by which the node group multiplies the strips of a table, at values of the base's inputs."""

from __future__ import annotations

from collections.abc import Callable, Collection

import numpy as np

from ...kinds.table import AGAIN, BASE, BASE_WEIGHT, DARK, FIRST, OWN, THROWN_BACK, TRAPPED, Strip, is_covered
from .geometric_series import gain, repeated


def strip_factors(strips: Collection[Strip], texels: Callable[[Strip], np.ndarray], color: np.ndarray,
                  metallic: float) -> dict[tuple[str, bool], np.ndarray | float]:
    """The factors of the strips with a closure's weight, by role and metal. `strips`: all strips of the table;
    `texels(strip)`: those of one of them, R G B along the last axis; `color`: R G B. The light of the base is a
    geometric series of its color, or below an interface as in bases.base_light and bases.covered."""
    covered, metals = is_covered(strips), sorted({strip.metal for strip in strips})
    factors: dict[tuple[str, bool], np.ndarray | float] = {}
    for metal in metals:
        share = 1.0 if len(metals) == 1 else metallic if metal else 1.0 - metallic
        factors[OWN, metal] = 1.0 if covered else share
        factors[DARK, metal] = share
        own = Strip(role=THROWN_BACK, metal=metal)
        if own not in strips or Strip(role=BASE_WEIGHT) in strips:
            continue
        back = texels(own)
        if not covered:
            factors[BASE, metal] = share * gain(color, back)
            continue
        if len(metals) > 1 and not metal:
            back = (1.0 - metallic) * back + metallic * texels(Strip(role=TRAPPED))
        factors[FIRST, metal] = share * color
        factors[AGAIN, metal] = share * repeated(color, back)
    return factors
