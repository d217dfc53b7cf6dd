# SPDX-License-Identifier: GPL-3.0-or-later
"""The bake: a pure function from a stack to a lookup table of closure weights."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Sequence

import numpy as np

from .. import _core
from ..closures import lobes, narrow_lobes
from ..closures.axes import COLUMNS, TAU_ROWS
from ..closures.closure_table import grid_for
from ..common.arguments import check_choice, check_seed, check_whole
from ..common.errors import ArgumentError, StackError, shown
from ..common.progress import Progress, portion, stepper
from ..material.fields import channel
from ..material.layers import Lambert
from ..material.stack import Stack
from ..solver.solve import check_nodes, check_stack, thread_pool, tolerance_of
from .base_texture import over_texture
from .clean_row import mix_rows, without_varying
from .dropped_weights import folded
from .fit_report import all_rows, fit_report
from .lut import Lut
from .lut_header import PREFIX, SCHEMA, THROWN_BACK
from .mixture import Effort, Mixture, mix
from .slices import slices, solve_rows
from .strayed_light import compensated
from .tau_error import tau_error

# How many closures each basis holds at most: for lobes of rough boundaries, for other reflected light, for both
# together; for transmitted light; for a textured base.
BASES = {"standard": ((5, 5, 8), (4, 4, 4), (0, 2, 2)), "accurate": ((12, 13, 20), (8, 8, 8), (0, 4, 4))}
CHOICE = {"preview": {"overshoot": 0, "exchanges": 1, "column_stride": 6, "row_stride": 16},
          "final": {"overshoot": 2, "exchanges": 2, "column_stride": 4, "row_stride": 8}}


def bake(stack: Stack, quality: str = "final", seed: int = 0, progress: Progress | None = None,
         cancel: Callable[[], bool] | None = None, threads: int = 0,
         closures: Sequence[str] | None = None, row_stride: int = 1, nodes: int | None = None,
         basis: str = "standard") -> Lut:
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
    `basis`: "standard" renders about as fast as a Principled BSDF with coat and sheen; "accurate" takes some twenty
    closures.
    Boundaries reflect in a closure of their own, "mirror:ALPHA", exactly; facets narrower than alpha .03 are
    solved as smooth, and keep their width in that closure.
    The report: `fit_error` and `fit_error_transmission`, means over slices with view cosine >= .05 of the L2
    error over solid angle relative to the slice's norm; `worst_slice` and `worst_slice_transmission`, the largest
    of these errors and where it is (`mu_o`, `channel`, `side` of the viewer, `tau` of a varying layer); those of
    transmission are None for a stack on a base; `albedo_error`, the worst relative
    error of a fitted directional albedo; `strayed_light` of a sheet, see lamina.strayed_light.strayed_report, None
    for a stack on a base; `energy_error`, the solver's; `slice_errors`, of each slice; `row_errors`, by
    thickness of a varying layer: lists `tau`, `mean` and `worst`; `tau_error`, what is lost between rows, measured
    at quality "final" when every row is solved, see lamina.tau_error.
    Raises SolveError, StackError (channels) and ArgumentError, a ValueError: `row_stride` lies in [1, 33], `nodes` in
    [8, 160], `threads` in [0, 1024]."""
    check_stack(stack)
    tolerance_of(quality)
    seed, nodes = check_seed(seed), check_nodes(nodes)
    row_stride = check_whole(row_stride, "row_stride", 1, TAU_ROWS)
    check_choice(basis, "basis", BASES)
    given = _by_kind(() if closures is None else closures)
    if stack.channels not in (1, 3):
        raise StackError(f"channels = {stack.channels}: must be 1 or 3 (R G B) for a lookup table")
    stack.require_air_below()
    started = time.perf_counter()
    step = stepper("the bake", progress, cancel)
    solved = solve_rows(narrow_lobes.resolved(stack), quality, threads, portion(step, 0.0, 0.3), row_stride, nodes)
    pool = thread_pool(threads)
    grid, made = grid_for(quality, narrow_lobes.narrowest(stack)), narrow_lobes.closures(stack)
    reflected, through, below = (Effort(*counts, **CHOICE[quality]) for counts in BASES[basis])
    parts: dict[str, Mixture] = {}

    def fit(kind, wanted, effort, step, own, given):
        if stack.varying is None:
            return mix(kind, wanted, grid, effort, pool, step, made=own, given=given, mixed=solved.is_sheet)
        own_clean = narrow_lobes.closures(without_varying(stack)) if own else ()
        return mix_rows(kind, wanted, grid, effort, pool, step, made=own, made_clean=own_clean,
                        given=given, mixed=solved.is_sheet)

    if _is_textured(stack):
        seen, base = over_texture(solved, grid, pool, portion(step, 0.3, 0.7))
    else:
        seen, base = slices(solved, grid, pool, portion(step, 0.3, 0.7)), None
    fitted = {}
    ends = np.linspace(0.7, 0.95, len(seen) + 1)
    for (kind, wanted), first, last in zip(seen.items(), ends, ends[1:], strict=False):
        effort, own = (reflected, made) if kind == "reflection" else (through, ())
        fitted[kind] = fit(kind, wanted, effort, portion(step, first, last), own, given[kind])
    if solved.is_sheet:
        fitted["transmission"] = compensated(*fitted.values(), seen["transmission"], grid)
    for kind, wanted in seen.items():
        parts[kind] = folded(fitted[kind], wanted, grid, solved.is_sheet)
        if np.any(wanted.direct):
            name = narrow_lobes.mirror(stack) if kind == "reflection" else "transparent"
            parts[name] = Mixture([name], wanted.direct[:, None])
    if base is not None:
        below = fit("reflection", base.slices, below, portion(step, 0.95, 0.97), (), given["base"])
        reflectance = [channel(stack.base.reflectance, c) for c in range(stack.channels)]
        below = folded(below, base.slices, grid, False, factor=base.gain(reflectance))
        parts |= base.parts(reflectance, seen["reflection"], parts["reflection"], below)
    between = None
    if stack.varying is not None and quality == "final":
        largest = [stack.optics(stack.varying, c)[1] for c in range(stack.channels)]
        between = tau_error(solved, largest, stack.varying, grid, pool, portion(step, 0.97, 1.0))
    step(1.0, "Done")
    # [side, closure, row, channel, column]
    weights = np.concatenate([one.weights for one in parts.values()], axis=1)
    weights = np.moveaxis(all_rows(weights, solved, 2), 3, 4)
    weights = np.ascontiguousarray(np.broadcast_to(weights, (*weights.shape[:4], 3)), np.float32)
    header = {
        "schema": SCHEMA,
        "stack": json.loads(stack.canonical()),
        "stack_hash": stack.hash,
        "quality": quality,
        "basis": basis,
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
        "closures": [name for one in parts.values() for name in one.closures],
        "report": fit_report(parts, seen, solved) | ({"tau_error": between} if between else {}),
    }
    return Lut(header, weights, time.perf_counter() - started)


def _by_kind(ids: Sequence[str]) -> dict[str, list[str]]:
    """Given closures by kind. Raises ArgumentError for one that is not in the dictionary, twice there, or too many."""
    if isinstance(ids, str) or not isinstance(ids, Sequence) or not all(isinstance(name, str) for name in ids):
        raise ArgumentError(f"closures = {shown(ids)}: must be a list of lobe ids")
    given: dict[str, list[str]] = {"reflection": [], "transmission": [], "base": []}
    for name in ids:
        if name in ("transparent", THROWN_BACK) or name.startswith("mirror:"):
            continue  # has its strip whether asked for or not
        try:
            lobe = lobes.by_id(name.removeprefix(PREFIX))
            given["base" if name.startswith(PREFIX) else lobe.side].append(lobe.id)
        except KeyError:
            raise ArgumentError(f"closures: {shown(name)} is not in the dictionary") from None
    for kind, names in given.items():
        if len(set(names)) < len(names):
            raise ArgumentError(f"closures = {shown(list(ids))}: one is given twice")
        if len(names) > _core.MAX_CLOSURES:
            raise ArgumentError(f"closures: {len(names)} for {kind}, at most {_core.MAX_CLOSURES} can be fitted")
    return given


def _is_textured(stack: Stack) -> bool:
    return isinstance(stack.base, Lambert) and stack.base.textured
