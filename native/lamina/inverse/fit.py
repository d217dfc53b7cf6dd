# SPDX-License-Identifier: GPL-3.0-or-later
"""Fits the free parameters of a template to measurements."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ..common.arguments import check_kind
from ..common.errors import ArgumentError, quoted
from ..common.extras import require
from ..common.progress import Progress, stepper
from .measurements import Measurement
from .model import Model
from .result import Fit, is_surprising, judged
from .template import Template

# A fit ends when a correction by checked solves moves the parameters by fewer standard errors than this.
SETTLED = 0.02
# Searches of so many steps, each followed by so many corrections with the derivatives of the search.
MOST_SEARCHES, MOST_STEPS, MOST_CORRECTIONS = 3, 100, 5
# Where a search fails, others start from the best of so many points. Ranges with so large a ratio of their ends are
# filled by decades.
STARTS, TRIES, MANY = 30, 3, 30.0


def fit(measurements: Measurement | Sequence[Measurement], template: Template, threads: int = 0,
        progress: Progress | None = None, cancel: Callable[[], bool] | None = None) -> Fit:
    """The free parameters of `template` for which the stack agrees best with `measurements`, by least squares of the
    differences over their standard errors.

    Each measurement is a Brdf, Btdf, Reflectance, Transmittance or Profile of lamina.measurements, with as many
    channels as the template has. The search begins at the starting values of the template. Where its end does not
    describe the data, or lies at the end of a range with a probability below 5 %, it begins again at the best of many
    points that are spread over the ranges, up to three times, and the best end is returned. `threads` 0 uses every
    hardware thread; the result does not depend on it. `progress(fraction, text)` is called with a share that only
    rises, 0 to 1. `cancel()` is called often; Cancelled is raised if it returns true.

    Raises ArgumentError for arguments that do not fit together, StackError for parameters that make no stack,
    SolveError as lamina.solve does, and ExtraMissing without scipy.
    Method: dogleg steps in rectangular trust regions (Voglis and Lagaris 2004), and for later searches, which must
    not stay in corners, reflective ones (Branch, Coleman and Li 1999), with differences as derivatives: the stacks in
    which one parameter differs are solved channel by channel, and equal channels share one solution. The search uses
    few nodes, and is corrected by checked solves until it stays."""
    optimize = require("scipy.optimize", "lamina.fit")
    began = time.perf_counter()
    measurements = _checked(measurements)
    check_kind(template, "template", Template, "a lamina.Template")
    model = Model(measurements, template, threads, stepper("the fit", progress, cancel))
    model.begin()
    end = _settled(optimize.least_squares, model, model.start, "dogbox")
    if is_surprising(model, end.x, end.chi_squared):
        for start in _best_starts(model):
            other = _settled(optimize.least_squares, model, start, "trf")
            end = min(end, other, key=lambda one: one.chi_squared)
            if not is_surprising(model, end.x, end.chi_squared):
                break
        model.correct(end.x)
    found = judged(model, end.x, end.settled, time.perf_counter() - began)
    model.step(1.0, "Fitted")
    return found


def _checked(given) -> list[Measurement]:
    """The measurements as a list. Raises ArgumentError."""
    measurements = [given] if isinstance(given, Measurement) else given
    if not isinstance(measurements, list | tuple) or not measurements:
        raise ArgumentError(f"measurements = {quoted(given)}: must be a measurement, or a list of measurements")
    for index, one in enumerate(measurements):
        check_kind(one, f"measurements[{index}]", Measurement, "one of the classes of lamina.measurements")
    return list(measurements)


class _End(NamedTuple):
    """Where a search ended: the parameters, chi-squared, and whether it came to its end."""

    x: np.ndarray
    chi_squared: float
    settled: bool


def _best_starts(model: Model) -> list[np.ndarray]:
    """The best of STARTS points of a sequence that fills the ranges evenly (Roberts 2018), long ones by decades."""
    root = 2.0
    for _ in range(60):
        root = (1.0 + root) ** (1.0 / (len(model.start) + 1.0))
    steps = root ** -np.arange(1.0, len(model.start) + 1.0)
    shares = (0.5 + np.outer(np.arange(STARTS), steps)) % 1.0
    low, high = model.low, model.high
    decades = (low > 0.0) & (high > MANY * low)
    points = low + shares * (high - low)
    points[:, decades] = low[decades] * (high[decades] / low[decades])**shares[:, decades]
    model.begin()
    return sorted(points, key=lambda point: float(np.sum(model.residuals(point)**2)))[:TRIES]


def _settled(least_squares: Callable, model: Model, x: np.ndarray, method: str) -> _End:
    """The best parameters that a search finds from `x`, with the corrections of the model. `method`: of SciPy's."""
    best = _End(x, math.inf, False)
    for _ in range(MOST_SEARCHES):
        found = least_squares(model.residuals, x, model.jacobian, (model.low, model.high), method=method,
                              x_scale="jac", ftol=1e-4, xtol=1e-7, gtol=1e-12, max_nfev=MOST_STEPS)
        x = found.x
        for _ in range(MOST_CORRECTIONS):
            model.correct(x)
            away = model.residuals(x)
            if not away @ away < best.chi_squared:
                model.correct(best.x)
                return best
            best = _End(x, float(away @ away), found.status > 0)
            step, size = _step(found.jac, away, np.where(found.active_mask == 0, model.high - model.low, 0.0))
            if size < SETTLED:
                return best
            x = np.clip(x + step, model.low, model.high)
    model.correct(best.x)
    return best._replace(settled=False)


def _step(jacobian: np.ndarray, away: np.ndarray, span: np.ndarray) -> tuple[np.ndarray, float]:
    """(the step to the least squares of a linear model, its size in standard errors) along the directions that the data
    determine better than the ranges `span` do. Parameters of span 0 stay."""
    columns, sizes, rows = np.linalg.svd(jacobian * span, full_matrices=False)
    clear = sizes > 1.0
    amounts = columns.T[clear] @ away
    return -span * (rows[clear].T @ (amounts / sizes[clear])), float(np.linalg.norm(amounts))
