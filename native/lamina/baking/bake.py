# SPDX-License-Identifier: GPL-3.0-or-later
"""The bake: a pure function from a stack to a lookup table of closure weights."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from .. import _core
from ..closures import lobes, narrow_lobes
from ..closures.closure_table import grid_for
from ..common.arguments import check_choice, check_whole
from ..common.errors import ArgumentError, quoted
from ..common.progress import Progress, portion, portions, stepper
from ..kinds.bases import Lambert, ShaderBase
from ..kinds.fields import channel
from ..kinds.table import AGAIN, COLUMNS, DARK, FIRST, METAL, PREFIX, TAU_BEND, TAU_ROWS, lobe_of
from ..material.any_stack import AnyStack, as_stack
from ..material.stack import Stack
from ..solver.solve import check_nodes, thread_pool, tolerance_of
from . import covered_principled, principled_base
from .base_texture import over_texture
from .between_rows import LEAST, spread
from .dropped_weights import folded
from .fit_report import all_rows, fit_report, fitted_errors
from .input_error import has_inputs, own_errors, own_slices, range_errors
from .lut import Lut
from .lut_header import SCHEMA
from .mixture import Mixture
from .shader_base import on_lambert, shader_parts
from .slices import SolvedRows, require_table, slices, solve_rows
from .stack_fit import StackFit
from .strayed_light import compensated
from .tau_error import tau_error


@dataclass(frozen=True)
class Basis:
    """Largest numbers of closures in a table: (for lobes of rough boundaries, for other light, for both together); of
    a Principled base, beside the BSDF: (for a fixed color; for a color as an input: for the light over black, for the
    light that the color adds to a dielectric, and to a metal); of a Principled base below an interface: (for diffuse
    light of the base, for all its light)."""

    reflected: tuple[int, int, int]
    transmitted: tuple[int, int, int]
    textured_base: tuple[int, int, int]
    principled: tuple[int, int, int, int]
    covered: tuple[int, int]


CLOSURE_BASES = {
    "standard": Basis((5, 5, 8), (4, 4, 4), (0, 2, 2), (5, 3, 2, 4), (2, 9)),
    "accurate": Basis((12, 13, 20), (8, 8, 8), (0, 4, 4), (14, 9, 6, 6), (4, 18)),
}
# Effort of the search for closures: see mixture.Effort.
SEARCH = {"preview": {"overshoot": 0, "exchanges": 1, "column_stride": 6, "row_stride": 16},
          "final": {"overshoot": 2, "exchanges": 2, "column_stride": 4, "row_stride": 8}}

# Shares of a bake's time, measured on stacks with a varying layer.
TIME = {"solve": 0.1, "evaluate": 0.6, "fit": 0.1, "base": 0.02, "between": 0.2, "ranges": 0.1}


def bake(stack: AnyStack, quality: str = "final", progress: Progress | None = None,
         cancel: Callable[[], bool] | None = None, threads: int = 0, closures: Sequence[str] | None = None,
         row_stride: int = 1, nodes: int | None = None, basis: str = "standard") -> Lut:
    """Bakes a stack into a lookup table for Cycles. The same arguments give the same bytes for any number of `threads`
    (0: all hardware threads).

    `progress(fraction, text)` is called with the completed share of the work, from 0 to 1. `cancel()` is called often;
    the bake raises Cancelled if it returns true.
    `closures`: lobe ids, such as those of an earlier table, that are fitted in this order instead of a new choice. All
    tables then have the same layout while a stack is edited. Closures are still chosen for a kind of light (reflection
    or transmission) without a closure in the list, or with one that a sheet must not mix.
    `row_stride`: with n > 1 only every n-th row of a varying layer's thickness is solved, and the others are
    interpolated. This is for previews while a slider moves; errors are some per cent, more for dark bases at grazing
    views.
    `nodes` replaces the solver's choice of nodes per hemisphere, without its guarantee of accuracy; also for previews.
    `basis`: "standard" takes 1.1 to 2.1 times as long to render as a Principled BSDF, see docs/figures.md; "accurate"
    takes some twenty closures.
    Smooth boundaries are exact, with a closure of their own, "mirror:ALPHA". Facets narrower than alpha .03 are solved
    as mirrors with the energy of the facets, and only this closure has their width.
    The report: `fit_error` and `fit_error_transmission`, means over slices with view cosine >= .05 of the L2
    error over solid angle relative to the slice's norm; `worst_slice` and `worst_slice_transmission`, the largest
    of these errors and where it is (`mu_o`, `channel`, `side` of the viewer, `tau` of a varying layer); those of
    transmission are None for a stack on a base; `albedo_error`, the worst relative
    error of a fitted directional albedo; `strayed_light` of a sheet, see strayed_light.strayed_report, None
    for a stack on a base; `energy_error`, the solver's; `slice_errors`, of each slice; `row_errors`, by
    thickness of a varying layer: lists `tau`, `mean` and `worst`; `tau_error`, the error of interpolation between
    rows, measured at quality "final" when every row is solved, see tau_error.tau_error; `base_error` of a stack on a
    ShaderBase, see shader_base.shader_parts.
    All errors of a base with inputs hold for the base's own values, and are relative to the light over this base.
    `input_error` states the errors over the ranges of the inputs: for colors 0, .5 and .95 (one in each channel),
    metallic 0, .5 and 1, and roughness .15 and .25, at quality "final" also .45 and .85; of a varying layer, for three
    thicknesses. `values`: a list with the values of the inputs, and for these `mean` and `worst`, errors of slices, and
    `albedo`, the largest relative error of the directional albedo; `mean` over all values; `worst` and `albedo`: the
    largest errors and where they are. `input_error` is left out if `row_stride` is above 1 or `closures`
    are given, that is in bakes while a slider moves.
    Raises SolveError, StackError (channels) and ArgumentError, a ValueError: `row_stride` lies in [1, 33], `nodes` in
    [8, 160], `threads` in [0, 1024]."""
    # Check the arguments
    stack = as_stack(stack)
    tolerance_of(quality)
    nodes = check_nodes(nodes)
    row_stride = check_whole(row_stride, "row_stride", 1, TAU_ROWS)
    limits = CLOSURE_BASES[check_choice(basis, "basis", CLOSURE_BASES)]
    given = _by_kind(closures)
    require_table(stack)
    started = time.perf_counter()
    measured = stack.varying is not None and quality == "final"
    has_texture = _is_textured(stack)
    shares = {**TIME, "base": TIME["base"] * has_texture, "between": TIME["between"] * measured,
              "ranges": TIME["ranges"] * has_texture}
    step = stepper("the bake", progress, cancel)
    steps = portions(step, shares)

    if principled_base.is_shown(stack) or covered_principled.is_covered(stack):
        header, table = _principled(stack, quality, basis, threads, step, row_stride, nodes, given)
        return Lut(header, table, time.perf_counter() - started)

    # Solve the stack for each thickness of its varying layer
    solved = solve_rows(on_lambert(stack), quality, threads, steps["solve"], row_stride, nodes)
    pool = thread_pool(threads)
    grid = grid_for(quality, narrow_lobes.narrowest(stack), narrow_lobes.has_halo(stack))

    # Evaluate the slices to be fitted by closures
    if _is_textured(stack) or isinstance(stack.base, ShaderBase):
        seen, base = over_texture(solved, grid, pool, steps["evaluate"])
    else:
        seen, base = slices(solved, grid, pool, steps["evaluate"]), None

    # Choose closures and fit their weights, for each kind of light
    fit = StackFit(stack, solved, grid, pool, SEARCH[quality])
    fitted = {}
    for number, (kind, wanted) in enumerate(seen.items()):
        part = portion(steps["fit"], number / len(seen), (number + 1) / len(seen))
        counts = limits.reflected if kind == "reflection" else limits.transmitted
        fitted[kind] = fit(kind, wanted, counts, given[kind], part, kind == "reflection")

    # Correct for light that strays beyond the horizon, and for weights that Cycles drops
    if solved.is_sheet:
        fitted["transmission"] = compensated(fitted["reflection"], fitted["transmission"],
                                             seen["transmission"], grid)
    parts: dict[str, Mixture] = {}
    for kind, wanted in seen.items():
        parts[kind] = fitted[kind] = folded(fitted[kind], wanted, grid, solved.is_sheet)
        if np.any(wanted.direct):
            name = narrow_lobes.mirror(stack) if kind == "reflection" else "transparent"
            parts[name] = Mixture([name], wanted.direct[:, None])

    # Weigh the light of a shader below, or fit the light that a textured base adds
    below_error, own = None, None
    if base is not None and isinstance(stack.base, ShaderBase):
        made, below_error = shader_parts(stack, solved, seen["reflection"],
                                         fitted["reflection"], base, grid, quality, threads, steps["base"])
        parts |= made
    elif base is not None:
        assert isinstance(stack.base, Lambert)
        below = fit("reflection", base.slices, limits.textured_base, given["base"], steps["base"], False)
        reflectance = [channel(stack.base.reflectance, c) for c in range(stack.channels)]
        below = folded(below, base.slices, grid, False, factor=base.gain(reflectance))
        parts |= base.parts(below)
        own = base.over(seen["reflection"], reflectance)

    # Measure the error of interpolation between rows
    between = None
    if stack.varying is not None and measured:
        largest = [stack.optics(stack.varying, c)[1] for c in range(stack.channels)]
        between = tau_error(solved, largest, stack.varying, grid, pool, steps["between"])

    # Assemble the table, and measure the errors of a base with an input
    weights, header = _weights(parts, solved), _header(stack, quality, basis, solved, parts)
    errors = fitted_errors(parts) if own is None else own_errors(header, weights, stack, solved, own, threads)
    report = fit_report(parts, seen, solved, *errors) | ({"tau_error": between} if between else {})
    report |= {"base_error": below_error} if below_error else {}
    if own is not None and row_stride == 1 and closures is None:
        report["input_error"] = range_errors(header, weights, stack, threads, steps["ranges"])
    step(1.0, "Done")
    return Lut({**header, "report": report}, weights, time.perf_counter() - started)


def _principled(stack: Stack, quality: str, basis: str, threads: int, step: Progress, row_stride: int,
                nodes: int | None, given: dict[str, list[str]]) -> tuple[dict, np.ndarray]:
    """(header, weights) of the table of a Principled base with inputs, or whose BSDF is part of the node group."""
    limits = CLOSURE_BASES[basis]
    options = (quality, threads, portion(step, 0.0, 0.75), row_stride, nodes, given)
    if principled_base.is_shown(stack):
        parts, solved, rough, own = principled_base.parts(stack, *options, limits.principled, SEARCH[quality])
    else:
        own = None
        parts, solved, rough = covered_principled.parts(stack, *options, limits.covered, limits.reflected,
                                                        SEARCH[quality])
    if LEAST <= len(solved.rows) < len(solved.axis) and principled_base.is_shown(stack):
        weights = _as_table(np.concatenate([spread(one, solved) for one in parts.values()], axis=1))
    else:
        weights = _weights(parts, solved)
    header = _header(stack, quality, basis, solved, parts)
    if rough:
        header["axes"]["roughness"] = {"count": len(rough), "values": rough}

    # Measure the errors: at the base's own values, and over the ranges of its inputs
    if own is None:
        solved, own = own_slices(stack, quality, threads, row_stride, nodes, portion(step, 0.75, 0.8))
    report = fit_report(parts, {}, solved, *own_errors(header, weights, stack, solved, own, threads))
    if has_inputs(stack) and row_stride == 1 and not any(given.values()):
        report["input_error"] = range_errors(header, weights, stack, threads, portion(step, 0.8, 1.0))
    step(1.0, "Done")
    return {**header, "report": report}, weights


def _weights(parts: dict[str, Mixture], solved: SolvedRows) -> np.ndarray:
    """float32 [side, closure, row, column, R G B]."""
    return _as_table(all_rows(np.concatenate([one.weights for one in parts.values()], axis=1), solved, 2))


def _as_table(weights: np.ndarray) -> np.ndarray:
    """float32 [side, closure, row, column, R G B], from [side, closure, row, channel, column]."""
    weights = np.moveaxis(weights, 3, 4)
    return np.ascontiguousarray(np.broadcast_to(weights, (*weights.shape[:4], 3)), np.float32)


def _header(stack: Stack, quality: str, basis: str, solved: SolvedRows, parts: dict[str, Mixture]) -> dict:
    """The table's header without the report."""
    return {
        "schema": SCHEMA,
        "version": _core.__version__,
        "stack": json.loads(stack.canonical()),
        "stack_hash": stack.hash,
        "quality": quality,
        "basis": basis,
        "seed": 0,  # not used by a bake, but required by readers of schema 1
        "sides": solved.sides,
        "axes": {
            "view": {"count": COLUMNS, "parameter": "theta_o/(pi/2)"},
            "tau": {
                "count": max(1, len(solved.axis)),
                "values": solved.axis,
                "layer": stack.varying,
                "parameter": f"t = tau/(tau+{TAU_BEND}), scaled so that the last row is the largest tau"
                             if solved.axis else "",
            },
        },
        "closures": [name for one in parts.values() for name in one.closures],
    }


def _by_kind(ids: Sequence[str] | None) -> dict[str, list[str]]:
    """Given closures by kind, or by the prefix of the strips of a Principled base for metallic 1; none for None. Raises
    ArgumentError for no closure, one that is unknown or given twice, and for too many."""
    if ids is None:
        ids = ()
    elif isinstance(ids, str) or not isinstance(ids, Sequence) or not all(isinstance(name, str) for name in ids):
        raise ArgumentError(f"closures = {quoted(ids)}: must be a list of lobe ids")
    elif not ids:
        raise ArgumentError("closures = []: must hold a lobe id, or be None for a choice by the bake")
    kinds = ("reflection", "transmission", "base", METAL, METAL + PREFIX, DARK, FIRST, AGAIN, METAL + DARK,
             METAL + FIRST, METAL + AGAIN)
    given: dict[str, list[str]] = {kind: [] for kind in kinds}
    for name in ids:
        if name == "transparent" or not lobe_of(name) or lobe_of(name).startswith("mirror:"):
            continue  # always in the table
        try:
            lobe = lobes.by_id(lobe_of(name))
        except KeyError:
            raise ArgumentError(f"closures: {quoted(name)} is not in the dictionary") from None
        prefix = name.removesuffix(lobe.id)
        given["base" if prefix == PREFIX else prefix or lobe.side].append(lobe.id)
    for kind, names in given.items():
        if len(set(names)) < len(names):
            raise ArgumentError(f"closures = {quoted(list(ids))}: one is given twice")
        if len(names) > _core.MAX_CLOSURES:
            raise ArgumentError(f"closures: {len(names)} for {kind}, at most {_core.MAX_CLOSURES} can be fitted")
    return given


def _is_textured(stack: Stack) -> bool:
    return isinstance(stack.base, Lambert) and stack.base.textured
