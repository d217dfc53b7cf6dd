# SPDX-License-Identifier: GPL-3.0-or-later
"""Mixtures with lobes that move with the view, beside a few fixed closures.

A lobe seen through a refracting boundary or an absorbing layer changes its width, its anisotropy and its direction with
the view. A closure of one width cannot follow, however many there are. The shapes of the moving lobes are fitted first,
beside a few broad closures. All other closures are then chosen for the whole material, and all weights are fitted."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ... import _core
from ...closures import closure_table, lobes, shaped_lobes
from ...closures.closure_table import LightGrid, view_cosines
from ...common.progress import Progress
from ...kinds.table import TAU_ROWS
from .azimuth_rows import AzimuthRows
from .between_rows import between
from .dropped_weights import LEAST_WEIGHT
from .mixture import ACCURATE, Effort, Mixture, selection
from .slices import MOST_KEPT, Slices, batches, stated

# Broad closures beside the lobes while their shapes are fitted.
BROAD = ("diffuse", "toon_03_06", "ggx_1", "diffuse_tiltm15")
# Columns and rows where shapes are fitted; they are linear between. Shapes change fastest at grazing views and in thin
# layers. Beyond the last view whose errors are reported, they stay as they are.
COLUMN_KNOTS = (*range(0, 48, 4), *range(48, 61, 2))
ROW_KNOTS = (0, 1, 2, 3, *range(4, TAU_ROWS, 2))
# All rows of azimuths are such rows. The most change of an unknown of the fit from one to the next:
AZIMUTH_CHANGE = 0.5
# Weight of the squared distance to the neighbours' shapes (in ln alpha, half the logarithm of the ratio of the widths,
# and k) against squared relative errors, as a root.
STIFFNESS = 0.05
# Numbers of fixed closures that are tried, as shares of the largest number. The first is taken whose objective is at
# most ENOUGH times the last one's.
SHARES, ENOUGH = (1 / 3, 2 / 3, 1), 1.1
# Least number beside the closures of the clean stack.
BESIDE = 2
# Cones for tilted lobes have edges, and moving lobes replace them.
CONE = "toon:"
# Weight of the worst slice's squared error against the mean of all, as in a choice of closures.
WORST_SHARE = 0.05


@dataclass(frozen=True)
class MovingFit:
    """Fits for a stack on an opaque base with `count` moving lobes. `made`: closures made for the stack's boundaries;
    `effort`: of the choice; `azimuths`: of the viewer, if the stack is anisotropic and rows are azimuths; `retro`: with
    lobes about the viewer."""

    count: int
    made: Sequence[str]
    grid: LightGrid
    effort: Effort
    pool: _core.ThreadPool
    azimuths: AzimuthRows | None = None
    retro: bool = False

    def __call__(self, wanted: Slices, given: Sequence[str], step: Progress,
                 clean: Mixture | None = None) -> Mixture | None:
        """The mixture of all rows; None where Cycles would drop all moving lobes of an isotropic stack. `given`:
        closures of an earlier table; without a moving one, a choice is made. `clean`: the mixture of row 0 alone, whose
        closures are part of the choice, and whose shapes row 0 has."""
        step(0.0, "Fitting lobes that move with the view")
        return self.mixture(wanted, self.shapes(wanted, None if clean is None else clean.shapes), given, step, clean)

    def mixture(self, wanted: Slices, shapes: np.ndarray, given: Sequence[str], step: Progress,
                clean: Mixture | None = None) -> Mixture | None:
        """As the call, for known shapes of the moving lobes, see `shapes`."""
        step(0.5, "Choosing closures")
        fit = _Fit(self, wanted, shapes)
        own = [name for name in given if not shaped_lobes.is_shaped(name)]
        if len(own) < len(given) and all(":" not in name or name in self.made for name in own):
            return fit.mixture(own)
        dictionary = [lobe.id for lobe in lobes.DICTIONARY if lobe.side == "reflection"]
        fixed = [] if clean is None else [name for name in clean.closures if not shaped_lobes.is_shaped(name)]
        made = [name for name in self.made if not name.startswith(CONE)]
        names = fit.chosen(list(dict.fromkeys([*fixed, *dictionary, *made])), len(fixed))
        mixture = fit.mixture(names)
        shown = mixture.weights[0, :self.count].mean(axis=2).max(axis=(1, 2)) >= LEAST_WEIGHT
        if not shown.any() and self.azimuths is None:
            return None
        if shown.all() or not shown.any() or (clean is not None and clean.shapes is not None):
            return mixture
        fewer = replace(self, count=int(shown.sum()))
        return _Fit(fewer, wanted, np.ascontiguousarray(fit.shapes[:, :, shown])).mixture(names)

    def shapes(self, wanted: Slices, clean: np.ndarray | None = None, stride: int = 1) -> np.ndarray:
        """Shapes of all rows and columns, [row, column, lobe, numbers]; `clean`: those of row 0, see Mixture.shapes.
        `stride`: of azimuths; the shapes of others are interpolated."""
        count, columns, grid = wanted.albedo.shape[1], np.array(COLUMN_KNOTS), self.grid
        knots = ROW_KNOTS if self.azimuths is None else range(0, count, stride)
        rows = sorted({row for row in knots if row < count} | {count - 1})
        options = _core.MovingFitOptions()
        options.lobes, options.stiffness, options.retro = self.count, STIFFNESS, self.retro
        views, dphi = _core.FitViews(view_cosines()[columns], np.empty(0), False), grid.dphi
        if self.azimuths is not None:
            options.most_change, options.following = AZIMUTH_CHANGE, 1.0
            views = _core.FitViews(view_cosines()[columns], self.azimuths.solved[rows], self.azimuths.mirrored)
            dphi = -dphi  # the fit's light turns the other way: see oriented_lobes
        found = _core.fit_moving(
            np.ascontiguousarray(wanted.values[0][rows][:, :, columns]),
            np.ascontiguousarray(closure_table.sampled(BROAD, grid, 1)[columns]), views,
            _core.LightDirections(grid.mu, dphi), grid.solid_angle, options,
            np.empty(0) if clean is None else np.ascontiguousarray(np.moveaxis(clean[0, :, 0], 2, 0)[columns]),
            self.pool)
        return between(between(found, columns, view_cosines().size, 1), np.array(rows), count, 0)


@dataclass(frozen=True)
class _Fixed:
    """Closures that do not move: `values` [column, closure, light] and `albedo` [column, closure]."""

    values: np.ndarray
    albedo: np.ndarray


@dataclass(frozen=True)
class _Fit:
    """The slices of one stack and the shapes [row, column, lobe, numbers] of the moving lobes."""

    how: MovingFit
    wanted: Slices
    shapes: np.ndarray

    @functools.cached_property
    def albedos(self) -> np.ndarray:
        """Directional albedos of the moving lobes, [row, column, lobe]."""
        azimuths = None if self.how.azimuths is None else self.how.azimuths.solved[:, None, None]
        return shaped_lobes.albedos(self.shapes, view_cosines()[:, None], azimuths)

    @property
    def ids(self) -> list[str]:
        """Of the moving lobes."""
        return shaped_lobes.ids(self.how.count, self.how.azimuths is not None)

    def chosen(self, candidates: Sequence[str], taken: int) -> list[str]:
        """Fixed closures for the whole material. The first `taken` candidates are part of the choice."""
        effort = self.how.effort
        last = self.shapes.shape[0] - 1
        rows = sorted({*range(0, last, effort.row_stride), last})
        table = self._table(self._fixed(candidates, effort.column_stride), rows, effort.column_stride)
        targets = [target for target in self._targets(table, rows, effort.column_stride) if target.norm2 > 0.0]
        names = [*self.ids, *candidates]
        if not targets:
            return [*candidates[:1]]
        found = []
        for share in SHARES:
            number = round(share * (effort.all - self.how.count))
            count = self.how.count + max(number, taken + BESIDE)
            options = selection(names, count, effort.overshoot, effort.exchanges, ACCURATE)
            choice = table.select(targets, options, list(range(len(names))), list(range(self.how.count + taken)),
                                  self.how.pool)
            found.append((choice.mean_error**2 + WORST_SHARE * choice.worst_error**2, choice.closures))
        kept = next(closures for score, closures in found if score <= ENOUGH * found[-1][0])
        return [names[k] for k in kept if k >= self.how.count]

    def mixture(self, names: Sequence[str]) -> Mixture:
        """The fit of all slices with these fixed closures."""
        wanted, rows = self.wanted, self.shapes.shape[0]
        fixed, every = self._fixed(names, 1), list(range(self.how.count + len(names)))
        weights, errors = [], []
        for part in batches(rows) if wanted.albedo.shape[2] <= MOST_KEPT else batches(rows, 1):
            some = list(range(rows))[part]
            table = self._table(fixed, some, 1)
            fitted, left = table.fit(self._targets(table, some, 1), every, self.how.pool)
            shape = wanted.albedo.shape[2], len(some), wanted.albedo.shape[3]
            weights.append(np.moveaxis(fitted.reshape(*shape, -1), (1, 3), (1, 0)))
            errors.append(left.reshape(shape).swapaxes(0, 1))
        black = wanted.albedo <= 0.0
        joined = np.where(black[:, None], 0.0, np.concatenate(weights, axis=1)[None])
        kept = joined[0].astype(np.float32)
        reached = (np.einsum("krxc,rck->rxc", kept[:self.how.count], self.albedos)
                   + np.einsum("krxc,ck->rxc", kept[self.how.count:], fixed.albedo))
        lost = np.abs(reached - wanted.albedo) / np.maximum(wanted.albedo, 1e-12) * ~black
        return Mixture([*self.ids, *names], joined,
                       np.where(black, np.nan, np.concatenate(errors)[None]), lost,
                       np.moveaxis(self.shapes, (0, 1, 2, 3), (1, 3, 0, 2))[None],
                       None if self.how.azimuths is None else self.how.azimuths.solved)

    def _fixed(self, names: Sequence[str], stride: int) -> _Fixed:
        grid, columns = self.how.grid, view_cosines()[::stride].size
        if not names:
            return _Fixed(np.zeros((columns, 0, grid.solid_angle.size)), np.zeros((columns, 0)))
        return _Fixed(closure_table.sampled(names, grid, stride), closure_table.column_albedos(tuple(names), stride))

    def _table(self, fixed: _Fixed, rows: Sequence[int], stride: int) -> _core.ClosureTable:
        """The core's table of the moving lobes and of fixed closures. Its columns are those of all rows, one row after
        the other."""
        grid, mu_o, count = self.how.grid, view_cosines()[::stride], self.how.count
        columns, closures, lights = fixed.values.shape
        values = np.empty((len(rows), columns, count + closures, lights))
        values[:, :, count:] = fixed.values
        for place, row in enumerate(rows):
            azimuth = None if self.how.azimuths is None else float(self.how.azimuths.solved[row])
            for lobe in range(count):
                values[place, :, lobe] = shaped_lobes.sampled(self.shapes[row, ::stride, lobe], mu_o, azimuth, grid)
        albedo = [np.concatenate([self.albedos[row, ::stride], fixed.albedo], axis=1) for row in rows]
        return _core.ClosureTable(values.reshape(-1, *values.shape[2:]), grid.solid_angle, np.concatenate(albedo))

    def _targets(self, table: _core.ClosureTable, rows: Sequence[int], stride: int):
        """The core's targets, [channel, row, column]."""
        values = self.wanted.values[0][list(rows)][:, :, ::stride].swapaxes(0, 1)
        albedo = self.wanted.albedo[0][list(rows)][:, :, ::stride].swapaxes(0, 1)
        channels = albedo.shape[0]
        return table.targets(np.ascontiguousarray(values).reshape(channels, -1, values.shape[-1]),
                             np.ascontiguousarray(albedo).reshape(channels, -1), self.how.pool)


def score(mixture: Mixture) -> float:
    """The objective of a choice at the views whose errors are reported: the mean squared error of the slices, and a
    share of the worst one."""
    errors = mixture.errors[..., stated()]
    squared = errors[np.isfinite(errors)] ** 2
    return float(squared.mean() + WORST_SHARE * squared.max()) if squared.size else 0.0
