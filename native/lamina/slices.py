# SPDX-License-Identifier: GPL-3.0-or-later
"""The slices of a scattering function that a lookup table holds: for each side, row of thickness, channel
and view cosine, what light from each direction contributes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .closure_table import LightGrid, view_cosines
from .lut import tau_rows
from .solve import ScatteringFunction, solve
from .stack import Stack


@dataclass(frozen=True)
class Slices:
    """`values`: f * cos(theta_i) in 1/sr, [side, row, channel, column, light]; `albedo`: their exact
    integrals, [side, row, channel, column]."""

    values: np.ndarray
    albedo: np.ndarray


@dataclass(frozen=True)
class SolvedRows:
    """A stack solved for each thickness of its varying layer; one row when none varies."""

    tau: list[float | None]
    functions: list[ScatteringFunction]
    sides: list[str]
    is_sheet: bool


def solve_rows(stack: Stack, quality: str, threads: int, step: Callable[[float, str], None]) -> SolvedRows:
    """Solves all rows; `step(fraction, text)` is called before each and may raise to stop."""
    step(0.0, "Solving the stack")
    full = solve(stack, quality, threads)
    # Seen from below, the sheet is the reversed stack; where that is the same stack, one side serves both.
    symmetric = Stack(tuple(reversed(stack.layers)), stack.base).canonical() == stack.canonical()
    is_sheet = stack.base is None
    sides = ["top", "bottom"] if is_sheet and not symmetric else ["top"]
    if stack.varying is None:
        return SolvedRows([None], [full], sides, is_sheet)
    taus = [stack.optics(stack.varying, c)[1] for c in range(stack.channels)]
    largest = max(taus)
    rows = [float(tau) for tau in tau_rows(largest)]
    functions = []
    for index, tau in enumerate(rows):
        step(index / len(rows), f"Solving thickness {index + 1} of {len(rows)}")
        share = tau / largest if largest > 0.0 else 0.0
        functions.append(full.with_thickness(stack.varying, [share * t for t in taus]))
    return SolvedRows(rows, functions, sides, is_sheet)


def slices(solved: SolvedRows, kind: str, grid: LightGrid, step: Callable[[float, str], None]) -> Slices:
    """Evaluates "reflection" or "transmission" as a viewer on each side sees it."""
    mu_o = view_cosines()
    path = {"reflection": "reflect", "transmission": "transmit"}[kind]
    values, albedos = [], []
    total = len(solved.sides) * len(solved.functions)
    for side in solved.sides:
        # What a viewer sees through a sheet came in on the other side.
        source = side if kind == "reflection" else {"top": "bottom", "bottom": "top"}[side]
        for function in solved.functions:
            step(len(values) / total, f"Evaluating {kind} {len(values) + 1} of {total}")
            brdf = function.grid(path, mu_o, grid.mu, grid.dphi, side=source)
            weighted = brdf * grid.mu[None, :, None, None]
            values.append(np.moveaxis(weighted.reshape(len(mu_o), -1, weighted.shape[-1]), -1, 0))
            # By reciprocity the directional albedo seen at mu_o is that of a beam from mu_o.
            if kind == "reflection":
                albedo = function.reflectance(mu_o, side)
            else:
                albedo = function.transmittance(mu_o, side, parts=True)[0]
            albedos.append(albedo.T)
    shape = (len(solved.sides), len(solved.functions))
    values, albedos = np.array(values), np.maximum(albedos, 0.0)
    return Slices(values.reshape(*shape, *values.shape[1:]), albedos.reshape(*shape, *albedos.shape[1:]))


def direct_light(solved: SolvedRows) -> np.ndarray:
    """Unscattered transmittance, [side, row, channel, column]."""
    mu_o = view_cosines()
    rows = [[f.transmittance(mu_o, side, parts=True)[1].T for f in solved.functions] for side in solved.sides]
    return np.array(rows)
