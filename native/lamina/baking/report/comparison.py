# SPDX-License-Identifier: GPL-3.0-or-later
"""The errors of a stored lookup table against an exactly solved stack, view by view.

A bake reports the errors that it measures while it fits. Here they are measured again, from the stored weights, on the
same grids and by the same norms."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ...closures.axes import column_angles
from ...closures.closure_table import view_cosines
from ...common.errors import ArgumentError
from ...common.progress import Progress, portions, silent, stepper
from ...kinds.bases import ShaderBase
from ...material.stack import Stack
from ..fit.fitted_function import FittedFunction, with_inputs_of
from ..fit.measured_error import Gauge, slice_errors
from ..fit.mixture import norms
from ..fit.row_functions import each
from ..fit.slices import covers_inputs, grid_of, require_table, shows_bsdf, slices, solve_rows
from .fit_report import error_report

TIME = {"solve": 0.3, "evaluate": 0.7}


@dataclass(frozen=True, eq=False)
class Comparison:
    """`errors` by kind of light, "reflection" and for sheets "transmission": the relative L2 error over solid angle of
    each slice, shape (sides of the viewer, thicknesses, channels, 64 views), nan where a slice is black; `mu_o`: the
    view cosines, from the normal to grazing, shape (64,); `tau`: the thicknesses of the varying layer, [None] if none
    varies; `sides`: of the viewer; `report`: the entries of the bake's report that are measured again."""

    errors: dict[str, np.ndarray]
    mu_o: np.ndarray
    tau: list[float | None]
    sides: list[str]
    report: dict

    @property
    def angles(self) -> np.ndarray:
        """View angles in radians, shape (64,)."""
        return column_angles()

    @property
    def mean(self) -> float:
        """The mean error of the reflection's slices with view cosines >= .05, like `fit_error` in a bake's report."""
        return self.report["fit_error"]

    @property
    def worst(self) -> dict:
        """The largest error of the reflection and where it is, like `worst_slice` in a bake's report."""
        return self.report["worst_slice"]

    def __repr__(self) -> str:
        through = self.report["fit_error_transmission"]
        beside = "" if through is None else f", of transmission {through:.2%}"
        return (f"<Comparison: mean error {self.mean:.2%}{beside}, worst {self.worst['error']:.2%} at mu_o = "
                f"{self.worst['mu_o']:.3f}, channel {self.worst['channel']}>")


def compare(header: dict, weights: np.ndarray, own: Stack, stack: Stack, threads: int, progress: Progress | None,
            cancel: Callable[[], bool] | None) -> Comparison:
    """The comparison of a table, baked from `own`, with `stack`: see Lut.compare."""
    _refuse(header, own, stack)
    steps = portions(stepper("the comparison", progress, cancel), TIME)
    channels = max(own.table_channels, stack.table_channels)
    quality = header["quality"]
    gauge = Gauge(grid_of(own if covers_inputs(own) else stack, quality), quality, threads, channels)

    # Solve the stack, and evaluate its slices
    solved = solve_rows(stack, gauge.quality, threads, steps["solve"])
    solved = replace(solved, sides=max(solved.sides, header["sides"], key=len))
    seen = slices(solved, gauge.grid, gauge.pool, steps["evaluate"])
    whole = {kind: norms(part.values, gauge.grid) for kind, part in seen.items()}
    if isinstance(stack.base, ShaderBase):  # the table holds the light over a black base
        functions = each(lambda function: function.with_base_reflectance(0.0), solved.functions)
        seen = slices(replace(solved, functions=functions), gauge.grid, gauge.pool, silent)

    # Sum the table's closures, and measure the difference
    function = with_inputs_of(FittedFunction(header, weights, own.given_base), stack.given_base)
    errors = {kind: slice_errors(function, solved, wanted, kind, gauge, whole[kind]) for kind, wanted in seen.items()}
    return Comparison(errors, view_cosines(), solved.tau, solved.sides, error_report(errors, solved))


def _refuse(header: dict, own: Stack, stack: Stack) -> None:
    """Raises StackError or ArgumentError for a stack that has other axes than the table."""
    require_table(stack)
    for what, of in (("is a thin sheet", lambda s: s.base is None), ("has a varying layer", lambda s: s.varying
                     is not None), ("shows a Principled base", shows_bsdf)):
        if of(own) != of(stack):
            first, second = ("table's stack", "given stack") if of(own) else ("given stack", "table's stack")
            raise ArgumentError(f"stack: the {first} {what} and the {second} does not")
    if own.is_oriented != stack.is_oriented or (own.is_oriented and own.tangent != stack.tangent):
        raise ArgumentError("stack: its anisotropic facets must have the angles of those of the table's stack")
    if stack.varying is not None:
        axis = header["axes"]["tau"]["values"]
        largest = max(stack.optics(stack.varying, c)[1] for c in range(stack.channels))
        if not math.isclose(largest, axis[-1], rel_tol=1e-9):
            raise ArgumentError(f"layers[{stack.varying}].tau = {largest:g}: must be {axis[-1]:g}, the largest "
                                "thickness in the table")
