# SPDX-License-Identifier: GPL-3.0-or-later
"""A Lambert base whose reflectance is a texture: exact for any value, from one bake.

All that a base of reflectance rho adds to a stack is rho A / (1 - rho r): A(o, i) = T(o) T(i) / pi, light that
comes through to the base and out again, and r, the share of diffuse light from the base that the layers throw
back to it (the geometric series of van de Hulst 1963). The table holds closures for the stack over black, others
for A, and r; a node computes rho / (1 - rho r)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from .closure_table import LightGrid
from .mixture import Mixture
from .slices import Slices, SolvedRows, slices

# Strips of the table that are weighted by the base: closures after this prefix, and r.
PREFIX = "base/"
THROWN_BACK = "base/thrown back"


@dataclass(frozen=True)
class TexturedBase:
    """`slices` of A; `thrown_back`, r, [side, row, channel, column], the same in all columns."""

    slices: Slices
    thrown_back: np.ndarray
    grid: LightGrid

    def gain(self, reflectance: np.ndarray) -> np.ndarray:
        """rho / (1 - rho r) of reflectances that broadcast to [side, row, channel, column]."""
        return reflectance / (1.0 - reflectance * self.thrown_back)

    def strip(self) -> Mixture:
        return Mixture([THROWN_BACK], self.thrown_back[:, None])


def over_texture(solved: SolvedRows, grid: LightGrid, pool,
                 step: Callable[[float, str], None]) -> tuple[dict[str, Slices], TexturedBase]:
    """(slices over black, the textured base) of a stack on a Lambert base."""

    def over(reflectance, part):
        functions = [function.with_base_reflectance(reflectance) for function in solved.functions]
        return slices(replace(solved, functions=functions), grid, pool,
                      lambda fraction, text: step((part + fraction) / 2.0, text))

    black, white = over(0.0, 0)["reflection"], over(1.0, 1)["reflection"]
    thrown_back = _thrown_back(solved)[None, :, :, None] * np.ones_like(black.albedo)
    share = 1.0 - thrown_back
    base = Slices(np.maximum(white.values - black.values, 0.0) * share[..., None],
                  np.maximum(white.albedo - black.albedo, 0.0) * share, None, np.zeros_like(black.albedo))
    return {"reflection": black}, TexturedBase(base, thrown_back, grid)


def _thrown_back(solved: SolvedRows) -> np.ndarray:
    """r, [row, channel]: with g = 1 / (1 - r) over white and 1/2 / (1 - r/2) over grey, their ratio is
    q = (2 - r) / (1 - r). Where no light reaches the base, 0."""
    black, grey, white = (np.array([function.with_base_reflectance(value).reflectance(1.0)
                                    for function in solved.functions]) for value in (0.0, 0.5, 1.0))
    seen = grey - black > 1e-12
    ratio = np.where(seen, (white - black) / np.where(seen, grey - black, 1.0), 2.0)
    return np.clip((ratio - 2.0) / (ratio - 1.0), 0.0, 1.0)
