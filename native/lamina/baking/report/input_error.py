# SPDX-License-Identifier: GPL-3.0-or-later
"""The errors of a table whose base has inputs: at the base's own values, and over the ranges of the inputs. The stack
is solved for each of some values, and its slices are compared with the table's fitted function."""

from __future__ import annotations

import itertools
import operator
from dataclasses import replace

import numpy as np

from ...closures.closure_table import view_cosines
from ...common.progress import Progress, silent
from ...kinds.bases import Lambert, PrincipledBase
from ...material.stack import Stack
from ..fit.fitted_function import FittedFunction, with_inputs_of
from ..fit.measured_error import Gauge, albedo_errors, slice_errors
from ..fit.mixture import mean_error, norms
from ..fit.slices import Slices, SolvedRows, grid_of, solve_rows, stated

# Values for which errors are measured. The colors are those of the three channels; roughnesses lie between rows.
COLORS = (0.0, 0.5, 0.95)
METALLIC = (0.0, 0.5, 1.0)
ROUGHNESSES = {"preview": (0.15, 0.25), "final": (0.15, 0.25, 0.45, 0.85)}
# Columns between two measured ones, and rows of thickness (of 33); thin layers fit worst.
COLUMN_STRIDE, ROWS = 3, (1, 4, 16)


def own_errors(header: dict, weights: np.ndarray, stack: Stack, solved: SolvedRows, wanted: Slices,
               threads: int) -> tuple[dict[str, np.ndarray], float]:
    """(errors of the slices `wanted` by kind, the largest error of the albedo) at the base's own values. They equal
    those of Lut.compare."""
    gauge = Gauge(grid_of(stack, header["quality"]), header["quality"], threads, stack.table_channels)
    function = FittedFunction(header, weights, stack.given_base)
    errors = slice_errors(function, solved, wanted, "reflection", gauge, norms(wanted.values, gauge.grid))
    return {"reflection": errors}, float(albedo_errors(function, solved, wanted, gauge)[..., stated()].max())


def range_errors(header: dict, weights: np.ndarray, stack: Stack, threads: int, step: Progress) -> dict:
    """The report's `input_error`, see lamina.bake."""
    bases, found = _values(stack, header["quality"]), []
    for number, base in enumerate(bases):
        step(number / len(bases), f"Measuring errors for values {number + 1} of {len(bases)}")
        found.append(_errors_at(header, weights, stack, base, threads))
    table = []
    for values, errors, albedo, _ in found:
        # The channels may have different colors
        channels = range(errors.shape[2]) if isinstance(values.get("color"), tuple) else [slice(None)]
        for index in channels:
            own = _of_channel(values, index)
            table.append({**own, "mean": mean_error(errors[:, :, index]), "worst": _largest(errors[:, :, index]),
                          "albedo": _largest(albedo[:, :, index])})
    size = operator.itemgetter("error")
    return {
        "mean": mean_error(np.concatenate([errors.ravel() for _, errors, _, _ in found])),
        "worst": max((_worst(values, errors, tau) for values, errors, _, tau in found), key=size),
        "albedo": max((_worst(values, albedo, tau) for values, _, albedo, tau in found), key=size),
        "values": table,
    }


def _errors_at(header: dict, weights: np.ndarray, stack: Stack, base, threads: int) -> tuple:
    """(values of the inputs, errors of slices, errors of the albedo, thicknesses of the rows) over one base; errors are
    [side, row, channel, column] at the columns that are measured."""
    other, quality = stack.over(base), header["quality"]
    function = with_inputs_of(FittedFunction(header, weights, stack.given_base), base)
    gauge = Gauge(grid_of(stack, quality), quality, threads, other.table_channels, COLUMN_STRIDE)
    solved = solve_rows(other, gauge.quality, threads, silent, only=ROWS)
    wanted = gauge.seen(solved, silent)
    shown = stated()[::COLUMN_STRIDE]
    errors = slice_errors(function, solved, wanted, "reflection", gauge, norms(wanted.values, gauge.grid))[..., shown]
    albedo = albedo_errors(function, solved, wanted, gauge)[..., shown]
    color = base.reflectance if isinstance(base, Lambert) else base.color
    values = {name: color if name == "color" else getattr(base, name) for name, given in function.has.items() if given}
    return values, errors, albedo, solved.tau


def _worst(values: dict, errors: np.ndarray, tau: list[float | None]) -> dict:
    """The largest error, and where it is."""
    found = np.nan_to_num(errors)
    _, row, index, column = np.unravel_index(int(found.argmax()), found.shape)
    return {"error": float(found.max()), "mu_o": float(view_cosines()[::COLUMN_STRIDE][column]),
            "channel": int(index), "tau": tau[row],
            **_of_channel(values, int(index))}


def _of_channel(values: dict, index) -> dict:
    """Values of inputs in one channel."""
    return {name: value[index] if isinstance(value, tuple) else value for name, value in values.items()}


def _largest(errors: np.ndarray) -> float:
    return float(np.nan_to_num(errors).max())


def _values(stack: Stack, quality: str) -> list:
    """The base at values of its inputs. Below layers with wavelengths a color is gray, see Stack."""
    base = stack.given_base
    colors = [COLORS] if stack.wavelengths is None else COLORS
    if isinstance(base, Lambert):
        return [replace(base, reflectance=color) for color in colors]
    assert isinstance(base, PrincipledBase)
    given = {"color": colors, "metallic": METALLIC, "roughness": ROUGHNESSES[quality]}
    names = [name for name in given if name in base.inputs]
    every: list[dict] = [dict(zip(names, values, strict=True))
                         for values in itertools.product(*(given[name] for name in names))]
    return [replace(base, **values) for values in every]
