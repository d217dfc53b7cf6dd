# SPDX-License-Identifier: GPL-3.0-or-later
"""The bake: a pure function from a stack to a lookup table of closure weights."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from . import _core, lobes
from .closure_table import LIGHT_NODES, Closures, light_grid, view_cosines
from .closure_table import closures as closures_of
from .errors import Cancelled, StackError
from .layers import Conductor, Interface
from .lut import COLUMNS, SCHEMA, Lut
from .slices import Slices, SolvedRows, slices, solve_rows
from .solve import thread_pool, tolerance_of
from .stack import Stack


@dataclass(frozen=True)
class Effort:
    """How much a quality spends on choosing closures: how many, how many more before some are dropped, rounds
    of exchange, and at which columns and rows it looks (the fit that follows uses all)."""

    reflection: int
    transmission: int
    overshoot: int
    exchanges: int
    column_stride: int
    row_stride: int


# Five closures render at about 1.4 times the Principled BSDF's time; more fit little better.
EFFORT = {"preview": Effort(5, 3, 0, 1, 6, 16), "final": Effort(5, 3, 2, 2, 4, 8)}
# The objective's factor for a closure made of a Principled BSDF: slow, and noisier than the rest.
PRINCIPLED_PENALTY = 1.1
# Errors are stated for view cosines from here on; nearer to grazing, closures are extrapolated.
STATED_COSINE = 0.05

Progress = Callable[[float, str], None]


def bake(stack: Stack, quality: str = "final", seed: int = 0, progress: Progress | None = None,
         cancel: Callable[[], bool] | None = None, threads: int = 0,
         closures: Sequence[str] | None = None, row_stride: int = 1, nodes: int | None = None) -> Lut:
    """Bakes a stack into a lookup table for Cycles. The same arguments give the same bytes, whatever
    `threads` (0: all hardware threads).

    `progress(fraction, text)` is told how far it is, 0 to 1; `cancel()` is asked often, and Cancelled is
    raised when it says yes. `seed` is for stacks that need Monte Carlo; none do yet. `closures`, lobe ids
    such as an earlier table's, are fitted as they are, in that order, instead of a choice of the best: tables
    of one layout follow each other while a stack is edited. A kind of which they hold none, or one that must
    not be mixed in a sheet, is chosen.
    `row_stride` > 1 solves just every so many rows of a varying layer's thickness and interpolates those
    between: for pictures while a slider moves, off by some per cent, more for dark bases seen at grazing.
    `nodes` overrides the solver's choice of nodes per hemisphere and its promise, for such pictures too.
    The report: `fit_error` and `fit_error_transmission`, means over slices with view cosine >= .05 of the L2
    error over solid angle relative to the slice's norm; `worst_slice`; `albedo_error`, the worst relative
    error of a directional albedo; `energy_error`, the solver's; `slice_errors`, of each slice.
    Raises SolveError, StackError (channels), ValueError."""
    tolerance_of(quality)
    if row_stride < 1:
        raise ValueError(f"row_stride = {row_stride}: must be at least 1")
    if nodes is not None and not 8 <= nodes <= 160:
        raise ValueError(f"nodes = {nodes}: must lie in [8, 160]")
    given = _by_kind(closures or ())
    if stack.channels not in (1, 3):
        raise StackError(f"channels = {stack.channels}: must be 1 or 3 (R G B) for a lookup table")
    for index, layer in enumerate(stack.layers):
        if isinstance(layer, Interface):
            raise StackError(f"layers[{index}].kind = 'interface': cannot be baked yet, only solved")
    if isinstance(stack.base, Conductor):
        raise StackError("base.kind = 'conductor': cannot be baked yet, only solved")
    started = time.perf_counter()
    step = _stepper(progress, cancel)
    solved = solve_rows(stack, quality, threads, _part(step, 0.0, 0.3), row_stride, nodes)
    pool = thread_pool(threads)
    seen = slices(solved, light_grid(*LIGHT_NODES[quality]), pool, _part(step, 0.3, 0.7))
    parts = [_fit(kind, solved, seen.kinds[kind], given[kind], quality, pool, _part(step, 0.7, 1.0))
             for kind in seen.kinds]
    if solved.is_sheet:
        parts.append(_Fit(["transparent"], seen.direct[:, None], None, None))
    step(1.0, "Done")
    weights = np.concatenate([part.weights for part in parts], axis=1)  # [side, closure, row, channel, column]
    weights = np.moveaxis(_all_rows(weights, solved, 2), 3, 4)
    weights = np.ascontiguousarray(np.broadcast_to(weights, (*weights.shape[:4], 3)), np.float32)
    header = {
        "schema": SCHEMA,
        "stack": json.loads(stack.canonical()),
        "stack_hash": stack.hash,
        "quality": quality,
        "seed": seed,
        "sides": solved.sides,
        "axes": {
            "view": {"count": COLUMNS, "parameter": "theta_o/(pi/2)"},
            "tau": {
                "count": max(1, len(solved.axis)),
                "values": solved.axis,
                "layer": stack.varying,
                "parameter": "t = tau/(tau+0.5), scaled so that the last row is the largest tau" if solved.axis else "",
            },
        },
        "closures": [name for part in parts for name in part.closures],
        "report": _report(parts, solved),
    }
    return Lut(header, weights, time.perf_counter() - started)


class _Fit:
    """One kind's closures, weights [side, closure, row, channel, column], errors and albedo errors
    [side, row, channel, column]; errors are None where nothing was fitted."""

    def __init__(self, closures, weights, errors, albedo_errors):
        self.closures, self.weights, self.errors, self.albedo_errors = closures, weights, errors, albedo_errors


def _fit(kind: str, solved: SolvedRows, wanted: Slices, given: list[str], quality: str, pool, step: Progress) -> _Fit:
    basis = closures_of(kind, quality)
    sound = _sound(basis, solved)
    if given and {basis.ids.index(name) for name in given} <= set(sound):
        basis, chosen = basis.only(given), list(range(len(given)))
    else:
        step(0.0, f"Choosing closures for {kind}")
        chosen = _choose(basis, wanted, kind, EFFORT[quality], sound, pool)
    step(0.5, f"Fitting {kind}")
    targets, exact = _targets(basis, wanted, pool)
    weights, errors = basis.table.fit(targets, chosen, pool)
    reached = np.einsum("sck,ck->sc", weights.astype(np.float32), basis.albedo[:, chosen])
    albedo_errors = np.abs(reached - exact) / np.maximum(exact, 1e-12) * (exact > 0.0)
    shape, columns = wanted.albedo.shape[:3], wanted.albedo.shape[3]
    return _Fit(
        [basis.ids[index] for index in chosen],
        np.moveaxis(weights.reshape(*shape, columns, len(chosen)), -1, 1),
        np.where(exact > 0.0, errors, np.nan).reshape(*shape, columns),
        albedo_errors.reshape(*shape, columns),
    )


def _by_kind(ids: Sequence[str]) -> dict[str, list[str]]:
    """Given closures by kind. Raises ValueError for one that is not in the dictionary, twice there, or too many."""
    given: dict[str, list[str]] = {"reflection": [], "transmission": []}
    for name in ids:
        if name == "transparent":
            continue  # unscattered light has its closure whether asked for or not
        try:
            given[lobes.by_id(name).side].append(name)
        except KeyError:
            raise ValueError(f"closures: {name!r} is not in the dictionary") from None
    for kind, names in given.items():
        if len(set(names)) < len(names):
            raise ValueError(f"closures = {list(ids)}: one is given twice")
        if len(names) > _core.MAX_CLOSURES:
            raise ValueError(f"closures: {len(names)} for {kind}, at most {_core.MAX_CLOSURES} can be fitted")
    return given


def _targets(basis: Closures, wanted: Slices, pool):
    """The core's targets of all slices, and their exact albedos, both with the slices flat but for columns."""
    columns = wanted.albedo.shape[3]
    flat = wanted.values.reshape(-1, columns, wanted.values.shape[-1])
    exact = wanted.albedo.reshape(-1, columns)
    return basis.table.targets(flat, exact, pool), exact


def _sound(basis: Closures, solved: SolvedRows) -> list[int]:
    """The closures that may be mixed. In a sheet only those about the normal: where reflection meets
    transmission, Cycles 4.5 samples lobes that cross the horizon so that up to 14 % of a sky is lost."""
    everything = range(len(basis.ids))
    return [k for k in everything if not solved.is_sheet or lobes.by_id(basis.ids[k]).node.normal == lobes.GEOMETRIC]


def _choose(basis: Closures, wanted: Slices, kind: str, effort: Effort, candidates, pool) -> list[int]:
    """The closures that together serve all slices best: the same for the whole material."""
    rows = wanted.albedo.shape[1]
    kept = sorted({*range(0, rows, effort.row_stride), rows - 1})
    few = Slices(wanted.values[:, kept], wanted.albedo[:, kept])
    targets = [t for t in _targets(basis, few, pool)[0] if t.column % effort.column_stride == 0 and t.norm2 > 0.0]
    if not targets:
        return candidates[:1]
    options = _core.SelectionOptions()
    options.closures = min(getattr(effort, kind), len(candidates))
    options.overshoot, options.swap_passes = effort.overshoot, effort.exchanges
    principled = [lobes.by_id(name).node.type == "ShaderNodeBsdfPrincipled" for name in basis.ids]
    options.penalty = [PRINCIPLED_PENALTY if slow else 1.0 for slow in principled]
    return list(basis.table.select(targets, options, candidates, [], pool).closures)


def _report(parts: list[_Fit], solved: SolvedRows) -> dict:
    stated = view_cosines() >= STATED_COSINE
    fitted = [part for part in parts if part.errors is not None]
    reflection, through = fitted[0], fitted[1] if len(fitted) > 1 else None
    albedo = max(float(part.albedo_errors[..., stated].max()) for part in fitted)
    functions = solved.functions
    through_errors = None if through is None else _all_rows(np.nan_to_num(through.errors), solved, 1).round(6).tolist()
    return {
        "fit_error": _mean(reflection.errors[..., stated]),
        "worst_slice": _worst(reflection.errors, stated, solved),
        "slice_errors": _all_rows(np.nan_to_num(reflection.errors), solved, 1).round(6).tolist(),
        "fit_error_transmission": None if through is None else _mean(through.errors[..., stated]),
        "slice_errors_transmission": through_errors,
        "albedo_error": albedo,
        "energy_error": max(f.checks["energy"] for f in functions),
        "closures": sum(len(part.closures) for part in parts),
        "solver": {
            "nodes": max(f.nodes for f in functions),
            "orders": max(f.orders for f in functions),
            "resolution_error": max(f.checks["resolution"] for f in functions),
        },
        "tau_rows": max(1, len(solved.axis)),
        "tau_rows_solved": len(solved.rows),
    }


def _all_rows(values: np.ndarray, solved: SolvedRows, axis: int) -> np.ndarray:
    """Values of the solved rows as values of all rows, linear in between."""
    wanted = np.arange(len(solved.axis))
    if len(solved.rows) >= len(wanted):
        return values
    after = np.clip(np.searchsorted(solved.rows, wanted), 1, None)
    rows = np.array(solved.rows)
    shape = [-1 if k == axis else 1 for k in range(values.ndim)]
    share = ((wanted - rows[after - 1]) / (rows[after] - rows[after - 1])).reshape(shape)
    return (1.0 - share) * values.take(after - 1, axis) + share * values.take(after, axis)


def _mean(errors: np.ndarray) -> float:
    """Mean over the slices that are not black; 0 when all are."""
    seen = errors[np.isfinite(errors)]
    return float(seen.mean()) if seen.size else 0.0


def _worst(errors: np.ndarray, stated: np.ndarray, solved: SolvedRows) -> dict:
    candidates = np.where(stated, np.nan_to_num(errors), 0.0)
    side, row, channel, column = np.unravel_index(int(candidates.argmax()), candidates.shape)
    return {
        "error": float(candidates[side, row, channel, column]),
        "mu_o": float(view_cosines()[column]),
        "channel": int(channel),
        "side": solved.sides[side],
        "tau": solved.tau[row],
    }


def _stepper(progress: Progress | None, cancel: Callable[[], bool] | None) -> Progress:
    """Tells the caller how far the bake is, and asks whether it shall stop."""

    def step(fraction: float, text: str) -> None:
        if cancel is not None and cancel():
            raise Cancelled("the bake was cancelled")
        if progress is not None:
            progress(fraction, text)

    return step


def _part(step: Progress, first: float, last: float) -> Progress:
    """A stepper for one part of the work."""
    return lambda fraction, text: step(first + (last - first) * fraction, text)
