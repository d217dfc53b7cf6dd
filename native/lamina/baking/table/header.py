# SPDX-License-Identifier: GPL-3.0-or-later
"""The header of a lookup table, and its validation, so that readers can rely on it."""

from __future__ import annotations

import json
import numbers
from collections.abc import Iterable, Sequence

import numpy as np

from ... import _core
from ...closures import lobes, shaped_lobes
from ...common.errors import quoted
from ...kinds.bases import PrincipledBase
from ...kinds.table import COLUMNS, OWN, PRINCIPLED, SHAPE, TAU_BEND, THROWN_BACK, TILT, Strip, is_covered, strips_of
from ...material.stack import Stack
from ..fit.slices import SolvedRows

SCHEMA = 1
COVERED_SCHEMA = 2  # of tables that also hold the stack without the film of its varying interface

MOST_TILT = 1e3  # k of a closure that moves with the view; of one about the viewer
_MISSING = object()
_TEXT, _NUMBER, _COUNT = "a text", "a number from 0", "a whole number from 0"
_NUMBERS = "a list of numbers from 0"
# Required and optional entries, by their path in the header.
_ALWAYS = {
    "stack.layers": "a list", "stack_hash": _TEXT, "quality": _TEXT, "seed": _COUNT, "sides": "a list",
    "closures": "a list", "axes.view.count": _COUNT, "axes.tau.count": _COUNT, "axes.tau.values": _NUMBERS,
    "report.fit_error": _NUMBER, "report.albedo_error": _NUMBER, "report.energy_error": _NUMBER,
    "report.closures": _COUNT, "report.tau_rows": _COUNT, "report.solver.nodes": _COUNT,
    "report.solver.orders": _COUNT, "report.worst_slice.error": _NUMBER, "report.worst_slice.mu_o": "a cosine",
    "report.worst_slice.channel": _COUNT, "report.worst_slice.side": _TEXT,
}  # fmt: skip
_OR_NONE = {"report.fit_error_transmission": _NUMBER, "report.worst_slice.tau": _NUMBER}
_IF_ANY = {
    "basis": {"basis": _TEXT},
    "version": {"version": _TEXT},
    "axes.roughness": {"axes.roughness.count": _COUNT, "axes.roughness.values": _NUMBERS},
    "axes.azimuth": {"axes.azimuth.count": _COUNT, "axes.azimuth.tangent": _NUMBER},
    "report.row_errors": {f"report.row_errors.{name}": _NUMBERS for name in ("tau", "mean", "worst")},
    "report.tau_error": {
        **{f"report.tau_error.{name}": _NUMBER for name in ("mean", "worst", "mirror", "worst_at.tau")},
        "report.tau_error.worst_at.mu_o": "a cosine",
    },
    "report.input_error": {f"report.input_error.{name}": _NUMBER for name in ("mean", "worst.error", "albedo.error")},
    "report.base_error": {f"report.base_error.{name}": _NUMBER for name in ("lambert", "metal", "unknown", "color")},
}


def new_header(stack: Stack, quality: str, basis: str, solved: SolvedRows, roughnesses: Sequence[float],
               strips: Iterable[Strip]) -> dict:
    """The header of a bake, without the report; `roughnesses`: those of an axis of roughness, or empty."""
    axes: dict = {
        "view": {"count": COLUMNS, "parameter": "theta_o/(pi/2)"},
        "tau": {
            "count": max(1, len(solved.axis)),
            "values": solved.axis,
            "layer": stack.varying,
            "parameter": f"t = tau/(tau+{TAU_BEND}), scaled so that the last row is the largest tau"
                         if solved.axis else "",
        },
    }
    if solved.azimuths is not None:
        axes["azimuth"] = {"count": solved.azimuths.count, "tangent": solved.azimuths.tangent,
                           "parameter": "((phi_o - tangent) mod pi)/pi"}
    if roughnesses:
        axes["roughness"] = {"count": len(roughnesses), "values": roughnesses}
    return {
        "schema": SCHEMA,
        "version": _core.__version__,
        "stack": json.loads(stack.canonical()),
        "stack_hash": stack.hash,
        "quality": quality,
        "basis": basis,
        "seed": 0,  # not used by a bake, but required by readers of schema 1
        "sides": solved.sides,
        "axes": axes,
        "closures": [strip.name for strip in strips],
    }


def with_uncovered(header: dict, inner: dict) -> dict:
    """The header of a table that also holds the stack without the film, whose header is `inner`."""
    return {**header, "schema": COVERED_SCHEMA, "uncovered": inner}


def problem(header, weights: np.ndarray, without: np.ndarray | None = None) -> str:
    """The first problem of a table, in words, or ''. `without`: the weights of the stack without the film, if any."""
    schema = header.get("schema") if isinstance(header, dict) else None
    if not isinstance(schema, int) or isinstance(schema, bool):
        return "not a Lamina lookup table"
    if schema > COVERED_SCHEMA:
        return f"schema {quoted(schema)} needs a newer Lamina, which reads up to {COVERED_SCHEMA}"
    if schema < 1:
        return f"schema = {quoted(schema)}: must be {SCHEMA} or {COVERED_SCHEMA}"
    return (_problem_of_fields(header) or _problem_of_closures(header) or _problem_of_weights(header, weights)
            or _problem_of_uncovered(header, without))


def _problem_of_uncovered(header: dict, without: np.ndarray | None) -> str:
    inner, tau = header.get("uncovered"), header["axes"]["tau"]
    if without is None or inner is None:
        return "" if inner is without else "uncovered: a table has its header and its weights, or neither"
    found = problem(inner, without)
    if found or inner["schema"] != SCHEMA:
        return f"uncovered: {found or f'schema must be {SCHEMA}'}"
    axis = inner["axes"]["tau"]
    if axis["count"] > 1 and (axis["count"], axis["values"]) != (tau["count"], tau["values"]):
        return "uncovered: axes.tau must be that of the table, or have one row"
    return ""


def _problem_of_fields(header: dict) -> str:
    wanted = dict(_ALWAYS)
    for place, more in _IF_ANY.items():
        if _at(header, place) is not _MISSING:
            wanted |= more
    for place, kind in _OR_NONE.items():
        if _at(header, place) is not None:
            wanted[place] = kind
    for place, kind in wanted.items():
        value = _at(header, place)
        if value is _MISSING:
            return f"the header of the lookup table is incomplete: {place} is missing"
        if not _FITS[kind](value):
            return f"{place} = {quoted(value)}: must be {kind}"
    return ""


def _problem_of_closures(header: dict) -> str:
    for name in header["closures"]:
        try:
            if closure := Strip.of(name).closure:
                lobes.recipe(closure)
        except (AttributeError, KeyError):
            return f"closure {quoted(name)}: this version of Lamina does not know it"
    strips = strips_of(header)
    for strip in strips:
        if not shaped_lobes.is_shaped(strip.closure):
            continue
        needed = (OWN, SHAPE, TILT) if shaped_lobes.is_oriented(strip.closure) else (OWN, SHAPE)
        for other in (Strip(strip.closure, role) for role in needed):
            if other not in strips:
                return f"closure {quoted(strip.name)}: {quoted(other.name)} is missing"
        if shaped_lobes.is_oriented(strip.closure) != ("azimuth" in header["axes"]):
            return f"closure {quoted(strip.name)}: axes.azimuth must be that of an anisotropic stack"
    if Strip(role=PRINCIPLED) in strips or is_covered(strips):
        for field in PrincipledBase.fields:
            if not _is_numbers(_at(header, f"stack.base.{field.name}")):
                return f"stack.base.{field.name}: must be a list of numbers from 0"
    if Strip(role=THROWN_BACK) in strips:
        is_principled = _at(header, "stack.base.kind") == PrincipledBase.kind
        place = "stack.base.color" if is_principled else "stack.base.reflectance"
        colour = _at(header, place)
        if not _is_numbers(colour) or len(colour) not in (1, 3):
            return f"{place}: must be 1 or 3 numbers, for the base has an input"
    return ""


def _problem_of_weights(header: dict, weights: np.ndarray) -> str:
    sides, tau = header["sides"], header["axes"]["tau"]
    if sides not in (["top"], ["top", "bottom"]):
        return f"sides = {quoted(sides)}: must be ['top'] or ['top', 'bottom']"
    if header["axes"]["view"]["count"] != COLUMNS:
        return f"axes.view.count = {header['axes']['view']['count']}: must be {COLUMNS}"
    if tau["count"] > 1 and len(tau["values"]) != tau["count"]:
        return f"axes.tau.values has {len(tau['values'])} entries: axes.tau.count says {quoted(tau['count'])}"
    if any(below < above for above, below in zip(tau["values"], tau["values"][1:], strict=False)):
        return f"axes.tau.values = {quoted(tau['values'])}: must rise"
    for place in _IF_ANY["report.row_errors"]:
        errors = _at(header, place)
        if errors is not _MISSING and len(errors) != len(tau["values"]):
            return f"{place} has {len(errors)} entries: must have one for each of axes.tau.values"
    counts = [header["axes"].get(name, {}).get("count", 1) for name in ("roughness", "azimuth")]
    rows = max(1, tau["count"]) * counts[0] * counts[1]
    shape = (len(sides), len(header["closures"]), rows, COLUMNS, 3)
    if weights.dtype != np.float32 or weights.shape != shape or not weights.size:
        return f"weights are {weights.dtype} {weights.shape}: the header says float32 {shape}"
    strips = strips_of(header)
    is_weight = np.array([strip.role not in (SHAPE, TILT) for strip in strips])
    if not np.all(np.isfinite(weights)) or weights[:, is_weight].min(initial=0.0) < 0.0:
        return "weights are negative or not finite"
    for strip, (first, second, third) in zip(strips, np.moveaxis(weights, (1, 4), (0, 1)), strict=True):
        if strip.role == SHAPE:
            is_oriented = shaped_lobes.is_oriented(strip.closure)
            anisotropy, tilt = (np.hypot(second, third), 0.0) if is_oriented else (np.abs(second), third)
            outside = (first <= 0.0) | (first > 1.0) | (anisotropy >= 1.0) | (np.abs(tilt) > MOST_TILT)
        else:
            outside = (strip.role == TILT) & (np.maximum(np.abs(first), np.abs(second)) > MOST_TILT)
        if np.any(outside):
            return "the shape of a closure is out of range"
    return ""


def _at(header: dict, place: str):
    """The header's value at a path such as "axes.tau.count", or _MISSING."""
    value = header
    for key in place.split("."):
        value = value.get(key, _MISSING) if isinstance(value, dict) else _MISSING
    return value


def _is_whole(value) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _is_number(value) -> bool:
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        return False
    return bool(0.0 <= value <= 1e300)  # type: ignore[operator]  # numbers.Real lacks the operators


def _is_numbers(value) -> bool:
    return isinstance(value, list) and all(map(_is_number, value))


_FITS = {
    _TEXT: lambda value: isinstance(value, str),
    "a list": lambda value: isinstance(value, list),
    _NUMBER: _is_number,
    _NUMBERS: _is_numbers,
    _COUNT: lambda value: _is_whole(value) and 0 <= value < 1 << 64,
    "a cosine": lambda value: _is_number(value) and value <= 1.0,
}
