# SPDX-License-Identifier: GPL-3.0-or-later
"""The light that a fit compares with measurements: equal channels are solved once, and evaluated once."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from .. import _core
from ..common.errors import StackError
from ..common.interruptible import interruptible
from ..kinds.bases import LEAST_ALPHA, PrincipledBase
from ..lateral.measured import measured_layers, measured_stack
from ..material.stack import Stack
from ..solver.core_calls import or_solve_error, thread_pool, tolerance_of
from ..solver.sharp_facets import has_sharp_facets
from ..solver.solve import core_stack

QUALITY = "final"
# The core joins every direction of a call with every other: short lists are fastest. The lobes of rough surfaces take
# longer than this, once a call.
PART, MOST_PARTS = 16, 64


class Solver:
    """Solves channels of stacks. `nodes`: of a hemisphere, fixed so that results are smooth in the parameters, or None
    for as many as the tolerance needs. `ask` is called during all work; what it raises ends the work. `solves`: the
    number of channels that were solved."""

    def __init__(self, threads: int, ask: Callable[[], object]):
        self.pool = thread_pool(threads)
        self.nodes: int | None = None
        self.solves = 0
        self.most_nodes = 0  # of the solutions that were made without fixed nodes
        self._ask = ask
        self._kept: dict = {}
        self._before: dict = {}

    def forget(self) -> None:
        """Gives the memory of solutions and values back, except of those since the last call: the core shares the rough
        boundaries of solutions that are alive."""
        self._before, self._kept = self._kept, {}

    def expected(self, measurement: Any, stack: Stack, index: int) -> np.ndarray:
        """What a Measurement would find in one channel of a stack, flat."""
        light = (BeamLight if measurement.needs_lengths else DirectionLight)(self, stack, index)
        return self.kept((light.key, id(measurement)), lambda: measurement.expected(light))

    def kept(self, key: tuple, make: Callable):
        """The result of `make`, which is called once for each key and number of nodes."""
        key = (self.nodes, *key)
        if key not in self._kept:
            self._kept[key] = make()
        return self._kept[key]

    def solved(self, call: Callable):
        """The result of a solve by the core. Raises SolveError, and what `ask` raises."""
        self.solves += 1
        return or_solve_error(lambda: interruptible(self.pool, call, self._ask))


class DirectionLight:
    """The solution of one channel: light by directions, without lengths."""

    def __init__(self, solver: Solver, stack: Stack, index: int):
        self._solver = solver
        self._stack = stack
        if isinstance(stack.base, PrincipledBase) and has_sharp_facets(stack, stack):
            least = math.ceil(1e3 * math.sqrt(LEAST_ALPHA)) / 1e3
            raise StackError(f"base.roughness = {stack.base.roughness:g}: must be 0, or at least {least:g} in a fit")
        self.key, self._layers, self._base = core_stack(stack, index)

    def points(self, side, path, *places: np.ndarray) -> np.ndarray:
        """BRDF or BTDF in 1/sr at directions (mu_o, mu_i, dphi)."""
        self._check_below(side, path)
        solution, flat = self._solution(), [place.ravel() for place in places]
        size = len(flat[0]) if self._is_rough or len(flat[0]) > PART * MOST_PARTS else PART
        return np.concatenate([solution.points(side, path, *(one[first:first + size] for one in flat),
                                               self._solver.pool) for first in range(0, len(flat[0]), size)])

    def fluxes(self, side, path, mu) -> tuple[np.ndarray, np.ndarray]:
        """(scattered, direct) shares of the incident flux, flat; `mu`: cosines or "diffuse"."""
        self._check_below(side, _core.Path.reflect)
        solution, pool = self._solution(), self._solver.pool
        found = solution.diffuse_fluxes(side, pool) if isinstance(mu, str) else solution.fluxes(side, mu.ravel(), pool)
        if path == _core.Path.reflect:
            return found.reflected, found.mirrored
        return found.transmitted, found.direct

    @property
    def _is_rough(self) -> bool:
        return any(getattr(part, "alpha", 0.0) > 0.0 for part in (*self._stack.layers, self._stack.base))

    def _solution(self):
        return self._solver.kept((self.key,), self._solve)

    def _solve(self):
        solver, tolerance = self._solver, tolerance_of(QUALITY)
        core = _core.Stack(self._layers, self._base)
        if solver.nodes is not None:
            return solver.solved(lambda: _core.solve_roughly(core, tolerance, solver.nodes, solver.pool))
        solution = solver.solved(lambda: _core.solve(core, tolerance, solver.pool))
        solver.most_nodes = max(solver.most_nodes, solution.nodes)
        return solution

    def _check_below(self, side, path) -> None:
        if side == _core.Side.bottom or path == _core.Path.transmit:
            self._stack.require_air_below()


class BeamLight:
    """The responses of one channel to pencil beams, by distance."""

    def __init__(self, solver: Solver, stack: Stack, index: int):
        self._solver = solver
        self.key = measured_layers(stack, index, QUALITY)

    def profile(self, path, mu: float, radii: np.ndarray) -> np.ndarray:
        """Flux density in 1/mm^2 at distances in mm, flat."""
        beam = self._solver.kept((self.key, mu), lambda: self._solve(mu))
        light = beam.reflected if path == _core.Path.reflect else beam.transmitted
        return light.density(radii.ravel(), self._solver.pool)

    def _solve(self, mu: float):
        solver = self._solver
        beam = _core.Searchlight(measured_stack(*self.key), mu, solver.nodes is not None)
        while not beam.done:
            solver.solved(lambda: beam.advance(solver.pool))
        return beam
