# SPDX-License-Identifier: GPL-3.0-or-later
"""The result of a fit, and what the data say about it."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from ..common.extras import require
from ..material.stack import Stack
from .measurements import Measurement
from .model import Model

# The data do not determine a parameter whose standard error is that of an even spread over its range.
UNDETERMINED = 1.0 / math.sqrt(12.0)
CLOSE = 0.98  # of a correlation: two parameters can hardly be told apart
AT_END = 1e-4  # of a range
# Probabilities of chi-squared that are surprising.
WRONG, TOO_GOOD = 1e-3, 1.0 - 1e-3
DOUBTFUL = 0.05  # of chi-squared at the end of a range


@dataclass(frozen=True, eq=False, repr=False)
class Fit:
    """What lamina.fit found.

    names: names of the free parameters.
    values, errors: the parameters and their standard errors by name, in the units of the quantities. Errors are those
        of a linear model at the best values; infinite for a parameter that the data do not determine.
    correlations: shape (parameters, parameters), in the order of `names`.
    fitted: the fitted values of each measurement, shapes (places, channels).
    sigmas: standard errors of the measured values in the same shapes, their relative part that of the fitted values.
    residuals: (measured - fitted) / sigma.
    chi_squared, degrees: the sum of squared residuals, and the number of values less that of parameters.
    probability: that values of this template with this noise give so large a chi-squared or a larger one; NaN without
        degrees of freedom.
    stack: the template with the fitted values.
    remarks: one sentence for each thing that the user should know; empty if there is nothing.
    measurements: what was given.
    solves, seconds: channels that were solved, and the time.
    """

    names: tuple[str, ...]
    values: dict[str, float]
    errors: dict[str, float]
    correlations: np.ndarray
    fitted: list[np.ndarray]
    sigmas: list[np.ndarray]
    residuals: list[np.ndarray]
    chi_squared: float
    degrees: int
    probability: float
    stack: Stack
    remarks: tuple[str, ...]
    measurements: list[Measurement]
    solves: int
    seconds: float

    def __repr__(self) -> str:
        return f"<Fit: {len(self.names)} parameters, chi-squared {self.chi_squared:.4g} at {self.degrees} degrees>"

    def __str__(self) -> str:
        width = max(map(len, self.names))
        lines = [f"{name:{width}}  {self.values[name]:.6g} +- {self.errors[name]:.2g}" for name in self.names]
        tested = "" if math.isnan(self.probability) else f", probability {self.probability:.2g}"
        lines.append(f"chi-squared {self.chi_squared:.4g} at {self.degrees} degrees of freedom{tested}")
        return "\n".join([*lines, *self.remarks])


def judged(model: Model, x: np.ndarray, settled: bool, seconds: float) -> Fit:
    """The result at the best parameters `x`."""
    away = model.residuals(x)
    fitted = model.expected(x)
    covariance, weakest = _covariance(model.jacobian(x), model.high - model.low)
    errors = np.sqrt(np.diag(covariance))
    finite = np.where(np.isfinite(errors) & (errors > 0.0), errors, 1.0)
    correlations = np.where(np.isfinite(covariance), covariance, 0.0) / np.outer(finite, finite)
    np.fill_diagonal(correlations, 1.0)
    chi_squared, degrees = float(away @ away), model.count - len(x)
    probability = _probability(chi_squared, degrees) if degrees > 0 else math.nan
    remarks = [*([] if settled else ["The search has not come to an end: start elsewhere, or free fewer parameters."]),
               *_ends(model, x), *_unclear(model, errors, correlations, weakest),
               *_test(chi_squared, degrees, probability)]
    return Fit(tuple(model.names), dict(zip(model.names, x.tolist(), strict=True)),
               dict(zip(model.names, errors.tolist(), strict=True)), correlations, fitted, list(model.sigmas),
               [(one.values - found) / sigma for one, found, sigma in
                zip(model.measurements, fitted, model.sigmas, strict=True)],
               chi_squared, degrees, probability,
               model.template.filled(dict(zip(model.parameters.values(), x.tolist(), strict=True))),
               tuple(remarks), list(model.measurements), model.solver.solves, seconds)


def is_surprising(model: Model, x: np.ndarray, chi_squared: float) -> bool:
    """True if so large a chi-squared has no chance with the right template at its best parameters, or little where a
    parameter lies at an end of its range, into which a search may have been led."""
    led = float(np.min(_room(model, x))) < AT_END
    return _probability(chi_squared, max(model.count - len(model.start), 1)) < (DOUBTFUL if led else WRONG)


def _room(model: Model, x: np.ndarray) -> np.ndarray:
    """The distance of each parameter from the nearer end of its range, as a share of the range."""
    return np.minimum(x - model.low, model.high - x) / (model.high - model.low)


def _probability(chi_squared: float, degrees: int) -> float:
    """That chi-squared is so large or larger by chance."""
    return float(require("scipy.special", "lamina.fit").gammaincc(0.5 * degrees, 0.5 * chi_squared))


def _covariance(jacobian: np.ndarray, span: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """(covariance, directions that the data leave open). A direction is open if its standard error is that of an even
    spread over the ranges `span`; parameters of directions that change nothing at all have infinite variances."""
    _, sizes, rows = np.linalg.svd(jacobian * span, full_matrices=False)
    blind = sizes <= 1e-9 * max(sizes[0], 1e-300)
    inverse = np.where(blind, 0.0, 1.0 / np.where(blind, 1.0, sizes))
    covariance = (rows.T * inverse**2) @ rows * np.outer(span, span)
    for row in rows[blind]:
        lost = np.abs(row) > 1e-3
        covariance[lost, lost] = math.inf
    return covariance, [row for row, one, none in zip(rows, inverse, blind, strict=True) if none or one > UNDETERMINED]


def _ends(model: Model, x: np.ndarray) -> list[str]:
    found = []
    for name, value, low, high, room in zip(model.names, x, model.low, model.high, _room(model, x), strict=True):
        if room < AT_END:
            end = low if value - low < high - value else high
            found.append(f"{name} lies at the end of its range, {end:g}, so its standard error and those of the others "
                         "may be wrong.")
    return found


def _unclear(model: Model, errors: np.ndarray, correlations: np.ndarray, weakest: list[np.ndarray]) -> list[str]:
    """Sentences on parameters that the data do not determine, alone or together."""
    found, told = [], set()
    for row in weakest:
        members = [name for name, share in zip(model.names, np.abs(row), strict=True) if share > 0.2]
        told.update(members)
        if len(members) == 1:
            found.append(f"The data do not determine {members[0]}.")
        else:
            found.append(f"The data cannot tell {', '.join(members[:-1])} and {members[-1]} apart.")
    for (i, first), (j, second) in itertools.combinations(enumerate(model.names), 2):
        if abs(correlations[i, j]) > CLOSE and not {first, second} <= told:
            found.append(f"The data can hardly tell {first} and {second} apart: their correlation is "
                         f"{correlations[i, j]:.4f}.")
    return list(dict.fromkeys(found))  # several open directions may have the same members


def _test(chi_squared: float, degrees: int, probability: float) -> list[str]:
    """What chi-squared says of the template and of the stated errors."""
    if degrees == 0:
        return ["There are as many values as parameters, so chi-squared cannot test the template."]
    if probability < WRONG:
        return [f"The template does not describe the data, or sigma is too small: chi-squared is {chi_squared:.4g} at "
                f"{degrees} degrees of freedom, probability {probability:.1g}."]
    if probability > TOO_GOOD:
        return [f"The stated sigma is too large: chi-squared is only {chi_squared:.3g} at {degrees} degrees of "
                "freedom."]
    return []
