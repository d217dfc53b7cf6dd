# SPDX-License-Identifier: GPL-3.0-or-later
"""The errors of a table whose base has inputs: at the base's own values, and over the ranges of the inputs. The stack
is solved for each of some values, and its slices are compared with the table's fitted function."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np

from ..closures.closure_table import view_cosines
from ..common.progress import Progress, portion, silent
from ..kinds.bases import Lambert, PrincipledBase
from ..material.stack import Stack
from .fit_report import STATED_COSINE, mean
from .fitted_function import FittedFunction, with_inputs_of
from .measured_error import Gauge, albedo_errors, slice_errors
from .mixture import norms
from .slices import Slices, SolvedRows, slices, solve_rows

# Values for which errors are measured. The colors are those of the three channels; roughnesses lie between rows.
COLORS = (0.0, 0.5, 0.95)
METALLIC = (0.0, 0.5, 1.0)
ROUGHNESSES = {"preview": (0.15, 0.25), "final": (0.15, 0.25, 0.45, 0.85)}
# Columns between two measured ones, and rows of thickness (of 33); thin layers fit worst.
COLUMN_STRIDE, ROWS = 3, (1, 4, 16)


def has_inputs(stack: Stack) -> bool:
    """True for a base with inputs of which the table knows the light exactly."""
    base = stack.base
    return bool(isinstance(base, PrincipledBase) and base.inputs) or (isinstance(base, Lambert) and base.textured)


def own_slices(stack: Stack, quality: str, threads: int, stride: int, nodes: int | None,
               step: Progress) -> tuple[SolvedRows, Slices]:
    """(every `stride`-th row of thickness, its slices) at the base's own values, on the grid of the bake."""
    gauge = Gauge.of(stack, quality, threads, stack.channels)
    solved = solve_rows(stack, quality, threads, portion(step, 0.0, 0.3), stride, nodes)
    return solved, slices(solved, gauge.grid, gauge.pool, portion(step, 0.3, 1.0))["reflection"]


def own_errors(header: dict, weights: np.ndarray, stack: Stack, solved: SolvedRows, wanted: Slices,
               threads: int) -> tuple[dict[str, np.ndarray], float]:
    """(errors of the slices `wanted` by kind, the largest error of the albedo) at the base's own values. They equal
    those of Lut.compare."""
    gauge = Gauge.of(stack, header["quality"], threads, stack.channels)
    function = FittedFunction(header, weights, stack.base)
    errors = slice_errors(function, solved, wanted, "reflection", gauge, norms(wanted.values, gauge.grid))
    albedo = albedo_errors(function, solved, wanted, gauge)[..., view_cosines() >= STATED_COSINE]
    return {"reflection": errors}, float(albedo.max())


def range_errors(header: dict, weights: np.ndarray, stack: Stack, threads: int, step: Progress) -> dict:
    """The report's `input_error`, see lamina.bake."""
    bases, found = _values(stack.base, header["quality"]), []
    for number, base in enumerate(bases):
        step(number / len(bases), f"Measuring errors for values {number + 1} of {len(bases)}")
        found.append(_errors_at(header, weights, stack, base, threads))
    table = []
    for values, errors, albedo, _ in found:
        # The channels have different colors
        channels = range(errors.shape[2]) if "color" in values else [slice(None)]
        for index in channels:
            own = {name: value[index] if name == "color" else value for name, value in values.items()}
            table.append({**own, "mean": mean(errors[:, :, index]), "worst": _largest(errors[:, :, index]),
                          "albedo": _largest(albedo[:, :, index])})
    return {
        "mean": mean(np.concatenate([errors.ravel() for _, errors, _, _ in found])),
        "worst": max((_worst(values, errors, tau) for values, errors, _, tau in found), key=_error),
        "albedo": max((_worst(values, albedo, tau) for values, _, albedo, tau in found), key=_error),
        "values": table,
    }


def _errors_at(header: dict, weights: np.ndarray, stack: Stack, base, threads: int) -> tuple:
    """(values of the inputs, errors of slices, errors of the albedo, thicknesses of the rows) over one base; errors are
    [side, row, channel, column] at the columns that are measured."""
    shown = Stack(stack.layers, base)
    function = with_inputs_of(FittedFunction(header, weights, stack.base), base)
    gauge = Gauge.of(stack, header["quality"], threads, shown.channels, COLUMN_STRIDE)
    solved = solve_rows(shown, gauge.quality, threads, silent, only=ROWS)
    wanted = gauge.seen(solved, silent)
    stated = _columns() >= STATED_COSINE
    errors = slice_errors(function, solved, wanted, "reflection", gauge, norms(wanted.values, gauge.grid))[..., stated]
    albedo = albedo_errors(function, solved, wanted, gauge)[..., stated]
    color = base.reflectance if isinstance(base, Lambert) else base.color
    values = {name: color if name == "color" else getattr(base, name) for name, given in function.has.items() if given}
    return values, errors, albedo, solved.tau


def _worst(values: dict, errors: np.ndarray, tau: list[float | None]) -> dict:
    """The largest error, and where it is."""
    found = np.nan_to_num(errors)
    _, row, index, column = np.unravel_index(int(found.argmax()), found.shape)
    return {"error": float(found.max()), "mu_o": float(_columns()[column]), "channel": int(index), "tau": tau[row],
            **{name: value[index] if name == "color" else value for name, value in values.items()}}


def _columns() -> np.ndarray:
    return view_cosines()[::COLUMN_STRIDE]


def _largest(errors: np.ndarray) -> float:
    return float(np.nan_to_num(errors).max())


def _error(worst: dict) -> float:
    return worst["error"]


def _values(base, quality: str) -> list:
    """The base at values of its inputs."""
    if isinstance(base, Lambert):
        return [replace(base, reflectance=COLORS)]
    given = {"color": [COLORS], "metallic": METALLIC, "roughness": ROUGHNESSES[quality]}
    names = [name for name in given if name in base.inputs]
    return [replace(base, **dict(zip(names, values, strict=True)))
            for values in itertools.product(*(given[name] for name in names))]
