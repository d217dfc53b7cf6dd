# SPDX-License-Identifier: GPL-3.0-or-later
"""A Lambert base whose reflectance is a texture: one bake is exact for any reflectance.

A base of reflectance rho adds rho A / (1 - rho r) to a stack over black, see geometric_series. A(o, i) = T(o) T(i) / pi
is light that reaches the base and leaves again. The table holds closures for the stack over black, others for A, and r;
a node computes rho / (1 - rho r)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...common.progress import Progress, portion
from ...kinds.bases import Lambert, ShaderBase
from ...kinds.fields import channel
from ...kinds.table import BASE, THROWN_BACK, Strip
from ...material.stack import Stack
from ..fit import geometric_series
from ..fit.dropped_weights import folded
from ..fit.mixture import Part
from ..fit.row_functions import each
from ..fit.slices import Slices, seen_whole, slices
from .fixed import Fixed
from .job import Basis


class OverBlack(Fixed):
    """A base whose light is kept apart from that of the layers over black. `added`: slices of A; `thrown_back`: r,
    [side, row, channel, column], the same in all columns."""

    added: Slices
    thrown_back: np.ndarray

    @staticmethod
    def most_strips(stack: Stack, limits: Basis) -> int:
        return Fixed.most_strips(stack, limits) + limits.textured_base[2] + 2  # two that weigh the light from below

    @property
    def gain(self) -> np.ndarray:
        """The factor of A at the base's own reflectance, [side, row, channel, column]."""
        base = self.stack.given_base
        assert isinstance(base, Lambert | ShaderBase)
        reflectance = np.array([channel(base.reflectance, c) for c in range(self.stack.table_channels)])
        return geometric_series.gain(reflectance[:, None], self.thrown_back)

    def own(self) -> Slices:
        """The slices of the stack over the base's own reflectance."""
        black, added, gain = self.seen["reflection"], self.added, self.gain
        return Slices(black.values + gain[..., None] * added.values, black.albedo + gain * added.albedo, None,
                      black.direct)

    def _slices(self) -> dict[str, Slices]:
        step = self.steps["evaluate"]
        black, white = self._over(0.0, portion(step, 0.0, 0.5)), self._over(1.0, portion(step, 0.5, 1.0))
        # r at the first column, the normal view. Boundaries reflect the same over any base
        grey = np.array([seen_whole(function.with_base_reflectance(0.5), 1.0) for function in self.solved.functions])
        dark, half, light = black.albedo[0, :, :, 0], grey - black.direct[0, :, :, 0], white.albedo[0, :, :, 0]
        thrown_back = geometric_series.thrown_back(dark, half, light)
        self.thrown_back = thrown_back[None, :, :, None] * np.ones_like(black.albedo)
        share = 1.0 - self.thrown_back
        self.added = Slices(np.maximum(white.values - black.values, 0.0) * share[..., None],
                            np.maximum(white.albedo - black.albedo, 0.0) * share, None, np.zeros_like(black.albedo))
        return {"reflection": black}

    def _over(self, reflectance: float, step: Progress) -> Slices:
        """The slices over another reflectance."""
        functions = each(lambda function: function.with_base_reflectance(reflectance), self.solved.functions)
        return slices(replace(self.solved, functions=functions), self.grid, self.pool, step)["reflection"]


class Colored(OverBlack):
    """Closures for the light that the base adds."""

    unused = ()

    def errors(self, header: dict, weights: np.ndarray) -> dict:
        between = self._errors_between_rows()
        return self._errors_of_inputs(header, weights, self.solved, self.own(), self.steps["ranges"]) | between

    def _base_parts(self) -> list[Part]:
        job = self.job
        fitted = self.fit("reflection", self.added, self.limits.textured_base, job.closures(BASE), self.steps["base"],
                          False)
        fitted = folded(fitted, self.added, self.grid, False, factor=self.gain)
        return [Part.of(fitted.closures, fitted.weights, BASE), Part.single(Strip(role=THROWN_BACK), self.thrown_back)]
