# SPDX-License-Identifier: GPL-3.0-or-later
"""A Principled base below layers without boundaries: the BSDF itself, attenuated by the layers, and closures for the
rest of the light.

Let V0 be the slice of the bare base and V that of the stack. The node group holds the Principled BSDF with the weight
w(view), the share of the base's lobe that layers neither scatter nor absorb, and closures fitted to V - w V0. Without
layers w is 1 and the rest is 0, so the group shows the BSDF itself.

Inputs of the group. The BSDF has the sockets' values. The rest depends on the base's color c as

    rest(c) = rest(0) + c / (1 - c r) * A

which is exact for a diffuse base, see geometric_series. For a metal, r is chosen for each view so that the albedo is
exact at c = 0, 1/2 and 1. Metallic mixes the rests of metallic 0 and 1 linearly. Roughness is an axis of the table,
around that of thickness: the rows of all thicknesses at the first roughness, then those at the next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...closures import narrow_lobes
from ...closures.closure_table import light_grid, view_cosines
from ...closures.lobes import ggx
from ...common.progress import Progress, portion, silent
from ...kinds.bases import PrincipledBase
from ...kinds.table import BASE, OWN, PRINCIPLED, ROUGHNESS_ROWS, THROWN_BACK, Strip
from ...material.stack import Stack
from ..fit import geometric_series
from ..fit.between_rows import LEAST, spread
from ..fit.dropped_weights import folded
from ..fit.measured_error import BROAD
from ..fit.mixture import Effort, Mixture, Part, mix, norms, values_of
from ..fit.slices import Slices, SolvedRows, inputs_of, joined, seen_whole, slices
from .base import WithInputs
from .job import Basis, Job

# Widths of closures for lobes that the layers broaden, beside those of the dictionary.
BROADENED = tuple(f"ggx:{alpha:g}" for alpha in (0.15, 0.22, 0.32, 0.45))
# A rest below this share of the albedo is rounding, as in the row without layers.
NEGLIGIBLE = 1e-5
# In place of 0 as the share of the light that the layers pass, for its logarithm.
LEAST_PASSED = 1e-30
# Colors over which errors are weighed in the choice of closures for a color input. Black is not among them: over a
# black metal there is so little light that its errors alone would decide.
COLORS = (0.05, 0.5, 0.95)
# With roughness as an input, only these rows of thickness are solved, unless a larger stride was asked for; the others
# are interpolated. At grazing views, thin layers change fastest.
ROUGH_ROWS = {"preview": (0, 2, 6, 12, 18, 25, 32), "final": (0, 1, 3, 6, 9, 12, 15, 18, 21, 25, 29, 32)}
ROUGH_STRIDE = {"preview": 6, "final": 3}


@dataclass(frozen=True)
class _Rests:
    """The rests of one metallic value: for the own color, or for black; and what a color adds. `whole2`: squared norms
    of V, [color, side, row, channel, column], for the own color or at each of COLORS. `thrown_back`: r, [side, row,
    channel, column]."""

    dark: Slices
    whole2: np.ndarray
    added: Slices | None = None
    thrown_back: np.ndarray | None = None


class Principled(WithInputs):
    """`only`: the rows of thickness that are solved, or None for those of the job."""

    rows = ROUGHNESS_ROWS

    def __init__(self, job: Job):
        super().__init__(job)
        few = self.stack.varying is not None and self.roughnesses and job.row_stride < ROUGH_STRIDE[job.quality]
        self.only = ROUGH_ROWS[job.quality] if few else None

    @staticmethod
    def most_strips(stack: Stack, limits: Basis) -> int:
        ends = 2 if "metallic" in inputs_of(stack) else 1
        strips = 1 + ends * (sum(limits.principled) + 2)  # the BSDF; its rests, and what is thrown back
        return strips * (ROUGHNESS_ROWS if "roughness" in inputs_of(stack) else 1)

    def parts(self) -> list[Part]:
        table: list[Part] = []
        ends, count = self.ends, len(self.every)
        fixed, dark, of_dielectric, of_metal = self.limits.principled
        for number, metallic in enumerate(ends):
            share = portion(self.step, number / len(ends), (number + 1) / len(ends))
            found = [self._rests(replace(self.base, roughness=roughness, metallic=metallic),
                                 portion(share, 0.7 * k / count, 0.7 * (k + 1) / count))
                     for k, roughness in enumerate(self.every)]
            self.solved, weight, rests, values = _joined(found)
            if not number:
                shape = rests.dark.albedo.shape
                table.append(Part.single(Strip(role=PRINCIPLED), np.broadcast_to(weight[None, :, None, :], shape)))
                self.own = None if self.inputs else values
            colored = rests.added is not None
            numbers = (dark, of_metal if metallic > 0.0 else of_dielectric) if colored else (fixed, 0)
            table += self._fitted(rests, number > 0, numbers, portion(share, 0.7, 1.0))
        return table

    def _all_rows(self, part: Part) -> np.ndarray:
        if LEAST <= len(self.solved.rows) < len(self.solved.axis):
            return spread(part, self.solved)
        return super()._all_rows(part)

    def _solved(self, base: PrincipledBase, step: Progress) -> tuple[SolvedRows, SolvedRows]:
        """(the stack, the bare base) with other values of the base."""
        layered = self.stack.with_facets(self.stack.layers, base)
        given = self.stack.given_base
        assert isinstance(given, PrincipledBase)
        shown = base if "color" in self.inputs else replace(base, color=given.color)
        return (self.job.solved(layered, portion(step, 0.0, 0.9), only=self.only),
                self.job.solved(Stack([], shown), portion(step, 0.9, 1.0), 1))

    def _rest(self, solved: SolvedRows, bare: SolvedRows, weight: np.ndarray, alpha: float,
              step: Progress) -> tuple[Slices, Slices]:
        """(the rest V - w V0, V) of a base whose facets have the width `alpha`."""
        grid, pool = self.grid, self.pool
        seen = slices(solved, grid, pool, step)["reflection"]
        channels = seen.albedo.shape[2]  # those of the bare base may be fewer
        clean = slices(bare, grid, pool, silent)["reflection"].each(
            lambda part: np.broadcast_to(part, (*part.shape[:2], channels, *part.shape[3:])))
        w = weight[None, :, None, :]
        values = seen.values - w[..., None] * clean.values
        if seen.lobes is not None and alpha < BROAD:
            values = values - seen.lobes + w[..., None] * clean.lobes
        albedo = seen.whole - w * clean.whole
        albedo = np.where(albedo > NEGLIGIBLE * seen.whole, albedo, 0.0)
        return Slices(np.where(albedo[..., None] > 0.0, values, 0.0), albedo, None, np.zeros_like(albedo)), seen

    def _rests(self, base: PrincipledBase, step: Progress) -> tuple[SolvedRows, np.ndarray, _Rests, Slices]:
        """(solved rows, w, the rests, the slices of the stack with its own color or a white one) for one roughness and
        one metallic value."""
        if "color" not in self.inputs:
            solved, bare = self._solved(base, portion(step, 0.0, 0.3))
            weight = attenuations(self.stack, base, solved)
            dark, values = self._rest(solved, bare, weight, base.alpha, portion(step, 0.3, 1.0))
            return solved, weight, _Rests(dark, norms(values.values, self.grid)[None] ** 2), values
        solved, bare = self._solved(replace(base, color=0.0), portion(step, 0.0, 0.1))
        weight = attenuations(self.stack, base, solved)
        dark, black = self._rest(solved, bare, weight, base.alpha, portion(step, 0.1, 0.4))
        solved, bare = self._solved(replace(base, color=1.0), portion(step, 0.4, 0.5))
        light, values = self._rest(solved, bare, weight, base.alpha, portion(step, 0.5, 0.8))
        half = _albedo_of_rest(*self._solved(replace(base, color=0.5), portion(step, 0.8, 0.9)), weight)
        thrown_back = geometric_series.thrown_back(dark.albedo, half, light.albedo)
        share = 1.0 - thrown_back
        albedo = (light.albedo - dark.albedo) * share
        albedo = np.where(albedo > NEGLIGIBLE * values.whole, albedo, 0.0)
        change = np.where(albedo[..., None] > 0.0, (light.values - dark.values) * share[..., None], 0.0)
        added = Slices(change, albedo, None, np.zeros_like(albedo))
        # V at a color, from V at black and at white, as the rest
        whole2 = [norms(black.values + (gain * share)[..., None] * (values.values - black.values), self.grid) ** 2
                  for gain in _gains(thrown_back)]
        return solved, weight, _Rests(dark, np.array(whole2), added, thrown_back), values

    def _fitted(self, rests: _Rests, metal: bool, counts: tuple[int, int], step: Progress) -> list[Part]:
        """The parts of the table with closures fitted to the rests of one metallic value. Errors of the choice are
        relative to all light of the stack, in the root mean square over colors: of thin layers the rest is a small
        part, and its error too."""
        job = self.job
        made = [*BROADENED, *narrow_lobes.halos(self.stack)]
        rows = _rows_of_choice(self.solved.rows, rests.dark.albedo.shape[1], self.search["row_stride"])

        def fit(wanted: Slices, weight: np.ndarray, count: int, role: str, step: Progress) -> Mixture:
            effort = Effort(0, count, count, **self.search)
            fitted = mix("reflection", wanted, self.grid, effort, self.pool, step, made=made, rows=rows,
                         given=job.closures(role, metal), whole=np.sqrt(_inverse(weight)))
            return folded(fitted, wanted, self.grid, False)

        inverse = _inverse(rests.whole2)
        dark = fit(rests.dark, inverse.mean(axis=0), counts[0], OWN, portion(step, 0.0, 0.6))
        found = [Part.of(dark.closures, dark.weights, OWN, metal)]
        if rests.added is None or rests.thrown_back is None:
            return found
        gains = _gains(rests.thrown_back)
        weight = (gains**2 * inverse).mean(axis=0)
        # The fit over black misses the light e, at all colors. The closures for the light that a color c adds, whose
        # factor is g(c), are fitted to that light and s e, with the s of the least sum of |e - s g e|^2 / |V|^2
        share = (gains * inverse).mean(axis=0) * _inverse(weight)
        missed = rests.dark.values - values_of(dark, self.grid)
        lit = rests.added.albedo > 0.0
        wanted = replace(rests.added, values=rests.added.values + (share * lit)[..., None] * missed)
        added = fit(wanted, weight, counts[1], BASE, portion(step, 0.6, 1.0))
        return [*found, Part.of(added.closures, added.weights, BASE, metal),
                Part.single(Strip(role=THROWN_BACK, metal=metal), rests.thrown_back)]


def _joined(found: list[tuple]) -> tuple[SolvedRows, np.ndarray, _Rests, Slices]:
    """Results of _rests for several roughnesses, one after the other along the axis of rows."""
    solved, weights, rests, values = zip(*found, strict=True)
    added = [rest.added for rest in rests if rest.added is not None]
    thrown_back = [rest.thrown_back for rest in rests if rest.thrown_back is not None]
    every = _Rests(joined([rest.dark for rest in rests]), np.concatenate([rest.whole2 for rest in rests], axis=2),
                    joined(added) if added else None,
                    np.concatenate(thrown_back, axis=1) if thrown_back else None)
    return solved[-1], np.concatenate(weights), every, values[0]


def _gains(thrown_back: np.ndarray) -> np.ndarray:
    """c / (1 - c r) for each of COLORS, [color, side, row, channel, column]."""
    return np.array([geometric_series.gain(color, thrown_back) for color in COLORS])


def _albedo_of_rest(solved: SolvedRows, bare: SolvedRows, weight: np.ndarray) -> np.ndarray:
    """The albedo of V - w V0, [side, row, channel, column], from fluxes alone."""
    mu = view_cosines()
    whole = np.stack([seen_whole(function, mu) for function in solved.functions])
    clean = bare.functions[0].reflectance(mu)
    return np.moveaxis(whole - weight[..., None] * clean, 2, 1)[None]


def attenuations(stack: Stack, base: PrincipledBase, solved: SolvedRows) -> np.ndarray:
    """w, [row, column]: of the light that no layer scatters or absorbs on its way to the base's lobe and back, the best
    multiple of the bare lobe (L2 over solid angle). Of channels that differ, the least; of wavelengths, as much as red,
    green and blue light passes at normal incidence."""
    mu = view_cosines()
    thickness = np.array([[_thickness(stack, c, row) for c in range(stack.channels)] for row in solved.shares])
    if stack.wavelengths is not None:
        thickness = -0.5 * np.log(np.maximum(stack.seen(np.exp(-2.0 * thickness)), LEAST_PASSED))
    tau = thickness.max(axis=1)[:, None]
    if base.alpha == 0.0:
        return np.exp(-2.0 * tau / mu)
    dense = light_grid(48, 32, 4.0)
    lobe = ggx(base.roughness).evaluate(mu[:, None, None], dense.mu[None, :, None], dense.dphi[None, None, :])
    lobe = (lobe.reshape(len(mu), -1) ** 2 * dense.solid_angle).reshape(len(mu), len(dense.mu), -1).sum(axis=2)
    passed = np.exp(-tau[:, :, None] / dense.mu)[:, 0]  # [row, light]
    return np.exp(-tau / mu) * (passed @ lobe.T) / lobe.sum(axis=1)


def _thickness(stack: Stack, index: int, share: float) -> float:
    """The optical thickness of all layers in one channel, with this share of the varying layer."""
    taus = [stack.optics(number, index)[1] for number in range(len(stack.layers))]
    return float(sum(tau * (share if number == stack.varying else 1.0) for number, tau in enumerate(taus)))


def _inverse(values: np.ndarray) -> np.ndarray:
    """1 / values, and 0 where these are 0."""
    return np.divide(1.0, values, out=np.zeros_like(values), where=values > 0.0)


def _rows_of_choice(thicknesses: Sequence[int], rows: int, stride: int) -> list[int]:
    """The rows for the choice of closures: about every `stride`-th thickness and the last, at each roughness.
    `thicknesses`: those that were solved, as rows of the table; `rows`: of all roughnesses."""
    count = len(thicknesses)
    kept = {int(np.abs(np.asarray(thicknesses) - row).argmin()) for row in range(stride, thicknesses[-1] + 1, stride)}
    return sorted(first + row for first in range(0, rows, count) for row in {*kept, count - 1})
