# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of a table's fitted function, measured against exact slices."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace

import numpy as np

from ... import _core
from ...closures import shaped_lobes
from ...closures.closure_table import LightGrid, column_albedos, sampled, view_cosines
from ...common.progress import silent
from ...kinds.bases import PrincipledBase
from ...kinds.table import PRINCIPLED
from ...material.stack import Stack
from ...solver.core_calls import thread_pool
from .fitted_function import FittedFunction, finite_lobe
from .mixture import norms, relative, seen_errors, weighted
from .slices import Slices, SolvedRows, evaluated, solve_rows

# From this width of its facets on, the attenuated lobe of a Principled base is compared with the lobe itself too. The
# light grid does not resolve narrower lobes, whose lights have nearly one cosine.
BROAD = 0.05


@dataclass(frozen=True, eq=False)
class Gauge:
    """How errors are measured: on `grid`, in so many channels, at every `stride`-th column of a table of this
    quality."""

    grid: LightGrid
    quality: str
    threads: int
    channels: int
    stride: int = 1

    @property
    def pool(self) -> _core.ThreadPool:
        return thread_pool(self.threads)

    def seen(self, solved: SolvedRows, step) -> Slices:
        """Exact slices of reflection at the columns that are measured."""
        return evaluated(solved.functions, solved, view_cosines()[::self.stride], self.grid, self.pool, step)

    def closures(self, function: FittedFunction, solved: SolvedRows) -> dict[str, np.ndarray]:
        """Weights of the closures at the solved rows, by id, [side, row, channel, column]."""
        return {name: np.moveaxis(weight[:, solved.places, ::self.stride, :self.channels], -1, 2)
                for name, weight in function.at_texels(len(solved.sides)).items()}

    def shapes(self, function: FittedFunction, solved: SolvedRows) -> dict[str, np.ndarray]:
        """Shapes of the closures that move with the view at the solved rows, by id, [side, row, column, numbers]."""
        return {name: shape[:, solved.places, ::self.stride]
                for name, shape in function.shapes_at_texels(len(solved.sides)).items()}


def slice_errors(function: FittedFunction, solved: SolvedRows, wanted: Slices, kind: str, gauge: Gauge,
                 whole: np.ndarray) -> np.ndarray:
    """Errors of the slices `wanted` of one kind of light, relative to the norms `whole`: [side, row, channel, column],
    nan where a slice is black."""
    closures = gauge.closures(function, solved)
    shapes = gauge.shapes(function, solved)
    values = -wanted.values
    for name, shape in shapes.items():
        values = values + weighted(closures.pop(name), shape, gauge.grid, gauge.stride, solved.turns)
    values = values + _sum(function, closures, kind, gauge)
    if PRINCIPLED in closures:
        base = function.base
        assert isinstance(base, PrincipledBase)
        values = values + _principled(base, closures[PRINCIPLED], wanted, gauge)
    return seen_errors(relative(norms(values, gauge.grid), whole), whole)


def albedo_errors(function: FittedFunction, solved: SolvedRows, wanted: Slices, gauge: Gauge) -> np.ndarray:
    """Relative errors of the directional albedo by reflection, specular light included: [side, row, channel, column], 0
    where a slice is black."""
    closures = gauge.closures(function, solved)
    total = np.zeros_like(next(iter(closures.values())))
    for name, shape in gauge.shapes(function, solved).items():
        moving = shaped_lobes.albedos(shape, view_cosines()[::gauge.stride])
        total += closures.pop(name) * moving[:, :, None]
    own = closures.pop(PRINCIPLED, None)
    if own is not None:
        base = function.base
        assert isinstance(base, PrincipledBase)
        total += own * _bare(base, gauge).whole
    ids = {name: function.shown(name) for name in closures}
    spread = list(dict.fromkeys(one for one in ids.values() if not one.startswith("mirror:")))
    known = dict(zip(spread, column_albedos(tuple(spread), gauge.stride).T, strict=True))
    for name, weight in closures.items():
        total += weight * known.get(ids[name], 1.0)
    whole = wanted.whole
    return seen_errors(np.abs(total - whole) / np.where(whole > 0.0, whole, np.inf), whole)


def _sum(function: FittedFunction, closures: dict[str, np.ndarray], kind: str, gauge: Gauge) -> np.ndarray:
    """The values of all closures of a kind, [side, row, channel, column, light]. Closures that stand for the specular
    light of the slices are left out."""
    weights, ids = [], []
    for name, weight in closures.items():
        lobe = None if function.is_specular(name) else finite_lobe(function.shown(name))
        if lobe is not None and lobe.side == kind:
            weights.append(weight)
            ids.append(lobe.id)
    return np.einsum("skrxc,ckl->srxcl", np.stack(weights, axis=1), _values(tuple(ids), gauge.grid, gauge.stride),
                     optimize=True)


@functools.lru_cache(maxsize=4)
def _values(ids: tuple[str, ...], grid: LightGrid, stride: int) -> np.ndarray:
    """Kept for live bakes, which use the same closures again."""
    return sampled(ids, grid, stride)


@functools.lru_cache(maxsize=1)
def _bare(base: PrincipledBase, gauge: Gauge) -> Slices:
    """The slices of the base without layers. Kept for the albedo, which is measured after the slices."""
    bare = solve_rows(Stack([], replace(base, inputs=())), gauge.quality, gauge.threads, silent)
    # A color from the table has three channels, also where all are equal
    return gauge.seen(bare, silent).each(lambda part: part[:, :, :gauge.channels])


def _principled(base: PrincipledBase, weight: np.ndarray, wanted: Slices, gauge: Gauge) -> np.ndarray:
    """The light of the BSDF itself. Of a narrow lobe, both the BSDF's and the stack's are left out, as in the fit: the
    grid does not resolve the lobe."""
    clean = _bare(base, gauge)
    values = weight[..., None] * clean.values
    if wanted.lobes is not None and clean.lobes is not None and base.alpha < BROAD:
        values = values + wanted.lobes - weight[..., None] * clean.lobes
    return values
