# SPDX-License-Identifier: GPL-3.0-or-later
"""A Lambert base whose reflectance is a texture: one bake is exact for any reflectance.

A base of reflectance rho adds rho A / (1 - rho r) to a stack over black, see geometric_series. A(o, i) = T(o) T(i) / pi
is light that reaches the base and leaves again. The table holds closures for the stack over black, others for A, and r;
a node computes rho / (1 - rho r)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..closures.closure_table import LightGrid
from ..common.progress import Progress, portion
from ..kinds.table import PREFIX, THROWN_BACK
from . import geometric_series
from .mixture import FittedMixture, Mixture
from .slices import Slices, SolvedRows, slices


@dataclass(frozen=True)
class TexturedBase:
    """`slices` of A; `thrown_back`, r, [side, row, channel, column], the same in all columns."""

    slices: Slices
    thrown_back: np.ndarray

    def gain(self, reflectance: list[float]) -> np.ndarray:
        """The factor of the weights of A for a reflectance, one per channel: [side, row, channel, column]."""
        return geometric_series.gain(np.array(reflectance)[:, None], self.thrown_back)

    def over(self, black: Slices, reflectance: list[float]) -> Slices:
        """The slices of the stack over a base of this reflectance, one per channel."""
        gain = self.gain(reflectance)
        return Slices(black.values + gain[..., None] * self.slices.values, black.albedo + gain * self.slices.albedo,
                      None, black.direct)

    def parts(self, fitted: FittedMixture) -> dict[str, Mixture]:
        """The table's parts beside those of the light over black; `fitted`: the fit of A."""
        return {
            "base": Mixture([PREFIX + name for name in fitted.closures], fitted.weights),
            "thrown back": Mixture([THROWN_BACK], self.thrown_back[:, None]),
        }


def over_texture(solved: SolvedRows, grid: LightGrid, pool,
                 step: Progress) -> tuple[dict[str, Slices], TexturedBase]:
    """(slices over black, the textured base) of a stack on a Lambert base."""

    def over(reflectance, step):
        functions = [function.with_base_reflectance(reflectance) for function in solved.functions]
        return slices(replace(solved, functions=functions), grid, pool, step)["reflection"]

    black, white = over(0.0, portion(step, 0.0, 0.5)), over(1.0, portion(step, 0.5, 1.0))
    thrown_back = _thrown_back(solved, black, white)[None, :, :, None] * np.ones_like(black.albedo)
    share = 1.0 - thrown_back
    base = Slices(np.maximum(white.values - black.values, 0.0) * share[..., None],
                  np.maximum(white.albedo - black.albedo, 0.0) * share, None, np.zeros_like(black.albedo))
    return {"reflection": black}, TexturedBase(base, thrown_back)


def _thrown_back(solved: SolvedRows, black: Slices, white: Slices) -> np.ndarray:
    """r, [row, channel], evaluated at the first column, the normal view."""
    dark, bright = black.albedo[0, :, :, 0], white.albedo[0, :, :, 0]
    grey = np.array([function.with_base_reflectance(0.5).reflectance(1.0) for function in solved.functions])
    grey = grey - black.direct[0, :, :, 0]  # boundaries reflect the same over any base
    return geometric_series.thrown_back(dark, grey, bright)
