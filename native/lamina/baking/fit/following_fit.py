# SPDX-License-Identifier: GPL-3.0-or-later
"""Mixtures whose closures follow the roughness of the base.

A row of roughness has its own width of each such closure. One choice of closures serves all rows: the columns of all
roughnesses lie side by side in one table of the core."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from ... import _core
from ...closures import closure_table, following_lobes
from ...closures.closure_table import LightGrid
from ...kinds.bases import LEAST_ALPHA
from .mixture import ACCURATE, selection
from .slices import Slices


@dataclass(frozen=True)
class FollowingFit:
    """Fits of slices whose rows are those of each roughness, one roughness after the other. `search`: the effort, see
    mixture.Effort. `step`: called before each fit."""

    grid: LightGrid
    roughnesses: Sequence[float]
    pool: _core.ThreadPool
    search: dict
    step: Callable[[], None]
    _tables: dict = field(default_factory=dict, init=False, repr=False)  # the last table

    def choose(self, wanted: Sequence[Slices], candidates: Sequence[str], count: int) -> list[str]:
        """At most `count` closures for all these slices."""
        self.step()
        names = list(dict.fromkeys(candidates))
        stride = self.search["column_stride"]
        table = self._table(names, stride)
        targets = [target for one in wanted for target in self._targets(table, one, stride, self.search["row_stride"])
                   if target.norm2 > 0.0]
        if not targets:
            return names[:1]
        options = selection(names, count, self.search["overshoot"], self.search["exchanges"], ACCURATE)
        every = list(range(len(names)))
        return [names[k] for k in table.select(targets, options, every, [], self.pool).closures]

    def fit(self, wanted: Slices, names: Sequence[str]) -> np.ndarray:
        """Weights [side, closure, row, channel, column]."""
        self.step()
        table = self._table(names, 1)
        weights, _ = table.fit(self._targets(table, wanted, 1), list(range(len(names))), self.pool)
        shape = self._as_columns(wanted.albedo).shape
        black = wanted.albedo <= 0.0
        weights = np.where(black[..., None], 0.0, self._as_rows(weights.reshape(*shape, len(names))))
        return np.moveaxis(weights, -1, 1)

    def _table(self, names: Sequence[str], stride: int) -> _core.ClosureTable:
        """The core's table with the columns of all roughnesses. A closure that is too narrow for the grid is black.
        With a stride, for a choice, albedos are sums over the grid."""
        key = (tuple(names), stride)
        if key not in self._tables:
            self._tables.clear()
            self._tables[key] = self._tabulated(names, stride)
        return self._tables[key]

    def _tabulated(self, names: Sequence[str], stride: int) -> _core.ClosureTable:
        every = [[following_lobes.at(name, roughness) for name in names] for roughness in self.roughnesses]
        distinct = list(dict.fromkeys(name for row in every for name in row))
        place = {name: k for k, name in enumerate(distinct)}
        known = closure_table.sampled(distinct, self.grid, stride)
        whole = closure_table.column_albedos(tuple(distinct)) if stride == 1 else known @ self.grid.solid_angle
        values, albedo = [], []
        for row, roughness in zip(every, self.roughnesses, strict=True):
            seen = np.array([not following_lobes.is_sharp(name, roughness, LEAST_ALPHA) for name in names])
            mine = [place[name] for name in row]
            values.append(known[:, mine] * seen[:, None])
            albedo.append(whole[:, mine] * seen)
        return _core.ClosureTable(np.concatenate(values), self.grid.solid_angle, np.concatenate(albedo))

    def _targets(self, table: _core.ClosureTable, wanted: Slices, stride: int, row_stride: int = 1):
        """The core's targets. Rows of one roughness become slices, and the roughnesses columns."""
        values, albedo = self._as_columns(wanted.values[:, :, :, ::stride]), wanted.albedo[..., ::stride]
        albedo = self._as_columns(albedo)[:, ::row_stride]
        values = values[:, ::row_stride].reshape(-1, *values.shape[3:])
        return table.targets(values, albedo.reshape(-1, albedo.shape[3]), self.pool)

    def _as_columns(self, values: np.ndarray) -> np.ndarray:
        """[side, row, channel, column, ...] as [side, row of a roughness, channel, column of all roughnesses, ...]."""
        sides, rows, channels, columns, *rest = values.shape
        count = len(self.roughnesses)
        split = values.reshape(sides, count, rows // count, channels, columns, *rest)
        return np.ascontiguousarray(np.moveaxis(split, 1, 3)).reshape(sides, rows // count, channels, count * columns,
                                                                      *rest)

    def _as_rows(self, values: np.ndarray) -> np.ndarray:
        """The inverse of _as_columns."""
        sides, rows, channels, columns, *rest = values.shape
        count = len(self.roughnesses)
        split = values.reshape(sides, rows, channels, count, columns // count, *rest)
        return np.moveaxis(split, 3, 1).reshape(sides, count * rows, channels, columns // count, *rest)
