# SPDX-License-Identifier: GPL-3.0-or-later
"""The report of a bake on its own accuracy."""

from __future__ import annotations

import numpy as np

from ...closures.closure_table import LightGrid, view_cosines
from ...common.observer import fading
from ..fit.between_rows import linear
from ..fit.mixture import Mixture, mean_error, norms, seen_errors
from ..fit.row_functions import numbers_of
from ..fit.slices import Slices, SolvedRows, stated


def fitted_errors(fitted: dict[str, Mixture], seen: dict[str, Slices],
                  grid: LightGrid) -> tuple[dict[str, np.ndarray], float]:
    """(errors of slices by kind, the largest error of the albedo) that were measured during the fit of `seen`."""
    return ({kind: seen_errors(part.errors, norms(seen[kind].values, grid)) for kind, part in fitted.items()},
            max(float(part.albedo_errors[..., stated()].max()) for part in fitted.values()))


def fit_report(strips: int, solved: SolvedRows, errors: dict[str, np.ndarray], albedo_error: float) -> dict:
    """The report of a table of so many strips, see lamina.bake; `errors`: see error_report."""
    numbers = numbers_of(solved.functions)
    return {
        **error_report(errors, solved),
        "albedo_error": albedo_error,
        "strayed_light": None,
        **_gamut(solved),
        "energy_error": max(one.checks["energy"] for one in numbers),
        "closures": strips,
        "solver": {
            "nodes": max(one.nodes for one in numbers),
            "orders": max(one.orders for one in numbers),
            "resolution_error": max(one.checks["resolution"] for one in numbers),
        },
        "tau_rows": max(1, len(solved.axis)),
        "tau_rows_solved": len(solved.rows),
    }


def _gamut(solved: SolvedRows) -> dict:
    """The entry `faded` of a table of wavelengths, from the thinnest and the thickest row."""
    stack = solved.functions[0].stack
    if stack.wavelengths is None:
        return {}
    mu = view_cosines()[stated()]
    scattered = [function.reflectance(mu, parts=True)[0] for function in (solved.functions[-1], solved.functions[0])]
    return {"faded": float(fading(stack.seen(np.array(scattered)), -1).max())}


def error_report(errors: dict[str, np.ndarray], solved: SolvedRows) -> dict:
    """The report's entries on the errors of slices, `errors` by kind: [side, row, channel, column], nan where a slice
    is black."""
    report: dict = {}
    for kind, ending in (("reflection", ""), ("transmission", "_transmission")):
        found = errors.get(kind)
        known = None if found is None else linear(np.nan_to_num(found), solved, 1).round(6).tolist()
        report[f"fit_error{ending}"] = None if found is None else mean_error(found[..., stated()])
        report[f"worst_slice{ending}"] = None if found is None else _worst(found, solved)
        report[f"slice_errors{ending}"] = known
    return report | _by_row(errors["reflection"][..., stated()], solved)


def _by_row(errors: np.ndarray, solved: SolvedRows) -> dict:
    """Fit error by thickness, for all rows; empty if no layer varies."""
    if not solved.axis:
        return {}
    errors = linear(np.nan_to_num(errors), solved, 1)
    errors = errors.reshape(len(errors), -1, len(solved.axis), *errors.shape[2:])  # azimuths, thicknesses
    errors = np.moveaxis(errors, 2, 0).reshape(len(solved.axis), -1)
    return {"row_errors": {"tau": solved.axis, "mean": errors.mean(axis=1).round(6).tolist(),
                           "worst": errors.max(axis=1).round(6).tolist()}}


def _worst(errors: np.ndarray, solved: SolvedRows) -> dict:
    candidates = np.where(stated(), np.nan_to_num(errors), 0.0)
    side, row, channel, column = np.unravel_index(int(candidates.argmax()), candidates.shape)
    turns, azimuths = solved.turns, solved.azimuths
    azimuth = {} if turns is None or azimuths is None else {"phi_o": float(turns[row] + azimuths.tangent)}
    return {
        "error": float(candidates[side, row, channel, column]),
        "mu_o": float(view_cosines()[column]),
        "channel": int(channel),
        "side": solved.sides[side],
        "tau": solved.tau[row % len(solved.tau)],
        **azimuth,
    }
