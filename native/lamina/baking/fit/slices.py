# SPDX-License-Identifier: GPL-3.0-or-later
"""The slices that a lookup table fits: the cosine-weighted scattering function over the light's directions, for each
side, row of thickness, channel and view cosine."""

from __future__ import annotations

import operator
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

import numpy as np

from ... import _core
from ...closures import narrow_lobes
from ...closures.axes import tau_at, tau_rows
from ...closures.closure_table import LightGrid, grid_for, oriented_grid, view_cosines
from ...common.errors import StackError
from ...common.observer import faded, fading, in_gamut
from ...kinds.bases import LEAST_ALPHA, Lambert, PrincipledBase, ShaderBase
from ...kinds.boundaries import Interface
from ...kinds.fields import channel_count
from ...kinds.table import TAU_ROWS, TAU_ROWS_OF_AZIMUTH
from ...material.stack import Stack
from ...solver.sharp_facets import take_lost
from ...solver.solve import ScatteringFunction, solve, solve_with_mirrors
from .azimuth_rows import AzimuthRows, require_oriented_table
from .row_functions import SolvedAgain

SIDES = {"top": _core.Side.top, "bottom": _core.Side.bottom}
PATHS = {"reflection": _core.Path.reflect, "transmission": _core.Path.transmit}
# Errors are reported for view cosines from here on; closer to grazing, closures are extrapolated.
STATED_COSINE = 0.05
# Rows between two calls of `step`; enough to keep all threads busy.
ROWS_AT_ONCE = 4
SOLVED_ROWS_OF_AZIMUTH = (0, 1, 2, 4, 6, 9, 12)  # and the last; the others are interpolated
MOST_KEPT = 3  # channels of isotropic stacks whose solved rows are kept


def stated() -> np.ndarray:
    """True for the columns whose errors are reported, shape (64,)."""
    return view_cosines() >= STATED_COSINE


@dataclass(frozen=True)
class Slices:
    """`values`: f * cos(theta_i) in 1/sr, [side, row, channel, column, light]; `albedo`: their exact integrals, [side,
    row, channel, column]; `lobes`: the part of the values that facets of rough boundaries scatter once, or None if all
    boundaries are smooth; `direct`: specular reflection or unscattered transmission, shaped like albedo."""

    values: np.ndarray
    albedo: np.ndarray
    lobes: np.ndarray | None
    direct: np.ndarray

    @property
    def whole(self) -> np.ndarray:
        """The albedo with specular reflection, shaped like albedo."""
        return self.albedo + self.direct

    def each(self, change: Callable[[np.ndarray], np.ndarray]) -> Slices:
        """Slices whose arrays are `change` of these."""
        lobes = None if self.lobes is None else change(self.lobes)
        return Slices(change(self.values), change(self.albedo), lobes, change(self.direct))


@dataclass(frozen=True)
class SolvedRows:
    """A stack solved for thicknesses of its varying layer; one row when none varies.

    `axis`: all thicknesses of the table; `rows`: indices of the solved ones; `tau`: their thicknesses. An anisotropic
    stack has as many rows for each of its `azimuths`: all thicknesses of the first, then those of the second, and so
    on."""

    axis: list[float]
    rows: list[int]
    tau: list[float | None]
    functions: Sequence[ScatteringFunction]
    sides: list[str]
    is_sheet: bool
    azimuths: AzimuthRows | None = None

    @property
    def turns(self) -> np.ndarray | None:
        """The azimuth of each solved row of an anisotropic stack."""
        return None if self.azimuths is None else np.repeat(self.azimuths.solved, len(self.rows))

    @property
    def places(self) -> list[int]:
        """The places of the solved rows among those of the table."""
        turns = 1 if self.azimuths is None else len(self.azimuths.solved)
        return [turn * max(1, len(self.axis)) + row for turn in range(turns) for row in self.rows]

    @property
    def shares(self) -> list[float]:
        """The varying layer's thickness at each solved row, as a share of the largest; 1 if none varies."""
        if not self.axis:
            return [1.0] * len(self.rows)
        return [_share(self.axis[row], self.axis[-1]) for row in self.rows]


def require_table(stack: Stack) -> None:
    """Raises StackError for a stack that no lookup table can hold."""
    if stack.table_channels not in (1, 3):
        raise StackError(f"channels = {stack.channels}: must be 1 or 3 (R G B) for a lookup table")
    base = stack.given_base
    if base is not None and base.shown:
        if stack.is_oriented:
            raise StackError("base: must have no input of the node group for a lookup table with anisotropic facets")
        if channel_count([("", getattr(base, base.shown))]) not in (1, 3):
            raise StackError(f"base.{base.shown}: must be one number, or red, green and blue, which Cycles takes")
    stack.require_air_below()
    if stack.is_oriented:
        require_oriented_table(stack)


def shows_bsdf(stack: Stack) -> bool:
    """True for a Principled base below media of the index of air, where the group holds the BSDF itself."""
    return isinstance(stack.base, PrincipledBase) and not any(isinstance(layer, Interface) for layer in stack.layers)


def inputs_of(stack: Stack) -> tuple[str, ...]:
    """The inputs of a Principled base, none of another base."""
    return stack.base.inputs if isinstance(stack.base, PrincipledBase) else ()


def covers_inputs(stack: Stack) -> bool:
    """True for a Principled base with inputs below an interface."""
    return bool(inputs_of(stack)) and not shows_bsdf(stack)


def grid_of(stack: Stack, quality: str) -> LightGrid:
    """The light grid of a bake of this stack."""
    if stack.is_oriented:
        return oriented_grid("preview" if stack.varying is not None else quality)
    if shows_bsdf(stack):
        narrowest = None
    elif "roughness" in inputs_of(stack):
        narrowest = LEAST_ALPHA
    else:
        narrowest = narrow_lobes.narrowest(stack)
    return grid_for(quality, narrowest, narrow_lobes.has_halo(stack), bool(narrow_lobes.retro_alphas(stack)))


def on_lambert(stack: Stack) -> Stack:
    """The stack with a Lambert base in place of a ShaderBase; any other stack as it is."""
    if not isinstance(stack.base, ShaderBase):
        return stack
    return stack.with_facets(stack.layers, Lambert(stack.base.reflectance))


def solve_rows(stack: Stack, quality: str, threads: int, step: Callable[[float, str], None],
               stride: int = 1, nodes: int | None = None, only: Collection[int] | None = None) -> SolvedRows:
    """Solves every `stride`-th row and the last, or `only` these rows; `step(fraction, text)` is called before each and
    may raise to cancel. A ShaderBase counts as a Lambert surface."""
    step(0.0, "Solving the stack")
    stack = on_lambert(stack)
    azimuths = AzimuthRows.of(stack, quality) if stack.is_oriented else None
    full = solve(stack, quality, threads) if azimuths else solve_with_mirrors(stack, quality, threads, nodes)
    # Seen from below, the sheet is the reversed stack; if both are equal, one side is used for both.
    symmetric = stack.turned().canonical() == stack.canonical()
    is_sheet = stack.base is None
    sides = ["top", "bottom"] if is_sheet and not symmetric else ["top"]
    varying = stack.varying
    if varying is None:
        return SolvedRows([], [0], [None], [full], sides, is_sheet, azimuths)
    taus = [stack.optics(varying, c)[1] for c in range(stack.channels)]
    largest = max(taus)
    axis = [float(tau) for tau in tau_rows(largest, TAU_ROWS if azimuths is None else TAU_ROWS_OF_AZIMUTH)]
    every = range(0, len(axis), stride) if azimuths is None else SOLVED_ROWS_OF_AZIMUTH
    rows = sorted({*every, len(axis) - 1}) if only is None else sorted(only)

    def made(known: ScatteringFunction, row: int) -> ScatteringFunction:
        return known.with_thickness(varying, [_share(axis[row], largest) * tau for tau in taus])

    # The lobes of boundaries are sharpest in the clean stack, so its resolution is sufficient for all other rows.
    clean = made(full, rows[0])
    functions: Sequence[ScatteringFunction]
    if stack.channels > MOST_KEPT or azimuths is not None:
        functions = SolvedAgain(lambda row: clean if row == rows[0] else made(clean, row), rows)
    else:
        kept = [clean]
        for count, row in enumerate(rows[1:], 1):
            step(count / len(rows), f"Solving thickness {count + 1} of {len(rows)}")
            kept.append(made(clean, row))
        functions = kept
    return SolvedRows(axis, rows, [axis[row] for row in rows], functions, sides, is_sheet, azimuths)


def slices(solved: SolvedRows, grid: LightGrid, pool, step: Callable[[float, str], None]) -> dict[str, Slices]:
    """The slices of each kind, "reflection" and for sheets "transmission", all rows for a viewer on each side; `step`
    is called before each batch of rows."""
    every = evaluated(solved.functions, solved, view_cosines(), grid, pool, step)
    sides = len(solved.sides)
    return {kind: every.each(operator.itemgetter(slice(number * sides, (number + 1) * sides)))
            for number, kind in enumerate(_sights(solved)[0])}


def evaluated(functions: Sequence[ScatteringFunction], solved: SolvedRows, mu_o: np.ndarray, grid: LightGrid,
              pool, step: Callable[[float, str], None]) -> Slices:
    """Slices of the stack `solved` with the thicknesses of `functions`, at view cosines `mu_o`. For a sheet, those of
    reflection and then those of transmission along the first axis. `step` is called before each batch of rows."""
    if solved.azimuths is not None:
        return _evaluate_azimuths(functions, solved, mu_o, grid, pool, step)
    sights = _sights(solved)[1]
    made = []
    for rows in batches(len(functions), 1 if isinstance(functions, SolvedAgain) else ROWS_AT_ONCE):
        step(rows.start / len(functions), f"Evaluating thickness {rows.start + 1} of {len(functions)}")
        made.append(_evaluate(functions[rows], sights, mu_o, grid, pool))
    values, lobes, albedo, direct = zip(*made, strict=True)
    return Slices(np.concatenate(values, axis=1), np.maximum(np.concatenate(albedo, axis=1), 0.0),
                  None if lobes[0] is None else np.concatenate(lobes, axis=1), np.concatenate(direct, axis=1))


def joined(found: Sequence[Slices], axis: int = 1) -> Slices:
    """Slices one after the other along an axis, by default that of rows, without their lobes."""
    values, albedo, direct = (np.concatenate([getattr(one, name) for one in found], axis=axis)
                              for name in ("values", "albedo", "direct"))
    return Slices(values, albedo, None, direct)


def _share(tau: float, largest: float) -> float:
    return tau / largest if largest > 0.0 else 0.0


def batches(rows: int, size: int = ROWS_AT_ONCE) -> list[slice]:
    """Parts of so many rows of thickness, `size` each; the last may be smaller."""
    return [slice(first, min(first + size, rows)) for first in range(0, rows, size)]


def shares_of_thickness(largest: float, rows: np.ndarray) -> np.ndarray:
    """Thickness at `rows`, integers or fractions between rows, as shares of the largest."""
    return tau_at(largest, rows) / largest if largest > 0.0 else np.zeros(len(rows))


def _sights(solved: SolvedRows):
    """(kinds, [(side, path) of each kind and side])."""
    kinds = ["reflection", "transmission"] if solved.is_sheet else ["reflection"]
    return kinds, [(SIDES[side], PATHS[kind]) for kind in kinds for side in solved.sides]


def _evaluate(functions: Sequence[ScatteringFunction], sights, mu_o: np.ndarray, grid: LightGrid, pool):
    """values [sight, row, channel, view, light], their lobes or None, albedo and direct [sight, row, channel,
    view]."""
    solutions = [solution for function in functions for solution in function.solutions]
    distinct = list({id(solution): solution for solution in solutions}.values())
    parts = _core.slices(distinct, sights, mu_o, grid.mu, grid.dphi, pool)
    place = {id(solution): k for k, solution in enumerate(distinct)}
    every = [place[id(solution)] for solution in solutions]  # channels may share one solution
    shape = (len(sights), len(functions), len(functions[0].solutions))

    def by_channel(part):
        part = part if len(distinct) == len(solutions) else part[:, every]
        return part.reshape(*shape, *part.shape[2:])

    values, albedo, direct = (by_channel(parts[k]) for k in (0, 2, 3))
    lobes = None if parts[1] is None else by_channel(parts[1])
    lost = [found for function in functions if (found := function.lost_by_facets(mu_o)) is not None]
    if lost:  # reflected to the top: the only sight of a stack on a base
        solved = albedo
        albedo, direct = take_lost(solved, direct, np.stack(lost).swapaxes(1, 2)[None])
        share = np.divide(albedo, solved, out=np.ones_like(solved), where=solved > 0.0)[..., None]
        values, lobes = values * share, None if lobes is None else lobes * share
    return _in_colours(values, lobes, albedo, direct, functions[0].stack)


def seen_whole(function: ScatteringFunction, mu_o) -> np.ndarray:
    """Directional albedos with specular light, [*mu_o, channel], as the slices have them: in red, green and blue in
    place of wavelengths."""
    if function.stack.wavelengths is None:
        return function.reflectance(mu_o)
    scattered, mirrored = map(function.stack.seen, function.reflectance(mu_o, parts=True))
    return in_gamut(scattered, -1) + in_gamut(mirrored, -1)


def _in_colours(values, lobes, albedo, direct, stack: Stack):
    """What `_evaluate` returns, in red, green and blue in place of wavelengths, if there are any. Slices whose colour
    is outside of the gamut fade towards gray, see observer.fading."""
    if stack.wavelengths is None:
        return values, lobes, albedo, direct
    values, albedo, direct = (stack.seen(part, 2) for part in (values, albedo, direct))
    share = fading(albedo, 2)
    values = faded(values, share[..., None], 2)
    if lobes is not None:
        lobes = faded(stack.seen(lobes, 2), share[..., None], 2)
    return values, lobes, faded(albedo, share, 2), in_gamut(direct, 2)


def _evaluate_azimuths(functions: Sequence[ScatteringFunction], solved: SolvedRows, mu_o: np.ndarray,
                       grid: LightGrid, pool, step: Callable[[float, str], None]) -> Slices:
    """Slices of an anisotropic stack. The first of several functions is that without the varying layer."""
    assert solved.azimuths is not None
    phi_o = solved.azimuths.solved + solved.azimuths.tangent
    step(0.0, "Evaluating azimuths")
    directions = mu_o, phi_o, grid.mu, grid.dphi, pool
    rows, solutions = len(functions), functions[0].solutions
    if rows > 1:
        bare = {id(one): _core.SlicesBelowMedium(one, *directions) for one in solutions}
        below = [bare[id(one)] for one in solutions]
    shape = len(phi_o), rows, len(solutions), len(mu_o)
    # Values in single precision: all thicknesses together take much memory
    found: list[np.ndarray] = [np.empty((*shape, grid.solid_angle.size), np.float32), np.empty(shape), np.empty(shape)]
    for number, function in enumerate(functions):
        step(number / rows, f"Evaluating thickness {number + 1} of {rows}")
        made = {}
        for index, one in enumerate(function.solutions):
            if id(one) not in made:
                made[id(one)] = one.slices(*directions) if rows == 1 else below[index].of(one, pool)
            for whole, part in zip(found, made[id(one)], strict=True):
                whole[:, number, index] = part.T.reshape(whole[:, number, index].shape)
    values, albedo, direct = (part.reshape(1, -1, *part.shape[2:]) for part in found)
    values, _, albedo, direct = _in_colours(values, None, np.maximum(albedo, 0.0), direct, functions[0].stack)
    return Slices(values, albedo, None, direct)
