# SPDX-License-Identifier: GPL-3.0-or-later
"""Fits the free parameters of a template to measurements."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import numpy as np

from ..common.arguments import check_kind, check_whole
from ..common.errors import ArgumentError, quoted
from ..common.extras import require
from ..common.progress import Progress, stepper
from .measurements import Measurement
from .model import Model
from .result import Fit, judged
from .template import Template

# A search ends when a correction by checked solves moves no parameter by this many standard errors.
SETTLED, MOST_ROUNDS, MOST_STEPS = 0.02, 6, 100


def fit(measurements: Measurement | Sequence[Measurement], template: Template, starts: int = 1, threads: int = 0,
        progress: Progress | None = None, cancel: Callable[[], bool] | None = None) -> Fit:
    """The free parameters of `template` for which the stack agrees best with `measurements`, by least squares of the
    differences over their standard errors.

    Each measurement is a Brdf, Btdf, Reflectance, Transmittance or Profile of lamina.measurements, with as many
    channels as the template has. `starts`: number of points from which the search may begin, 1 to 10000: the template's
    starting values, and others spread over the ranges; the search begins at the best. `threads` 0 uses every hardware
    thread; the result does not depend on it. `progress(fraction, text)` is called with a share that only rises, 0 to 1.
    `cancel()` is called often; Cancelled is raised if it returns true.

    Raises ArgumentError for arguments that do not fit together, StackError for parameters that make no stack,
    SolveError as lamina.solve does, and ExtraMissing without scipy.
    Method: trust region reflective (Branch, Coleman and Li 1999), with differences in place of derivatives: the stacks
    in which one parameter differs are solved channel by channel, and channels that are equal share one solution. The
    search uses few nodes, and is corrected by checked solves until it stays."""
    optimize = require("scipy.optimize", "lamina.fit")
    began = time.perf_counter()
    measurements = _checked(measurements)
    check_kind(template, "template", Template, "a lamina.Template")
    starts = check_whole(starts, "starts", 1, 10000)
    model = Model(measurements, template, threads, stepper("the fit", progress, cancel))
    model.begin()
    x, settled = _settled(optimize.least_squares, model, _best_start(model, starts))
    found = judged(model, x, settled, time.perf_counter() - began)
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


def _best_start(model: Model, starts: int) -> np.ndarray:
    """The best of some starting points: the template's, and those of a sequence that fills the ranges evenly (Roberts
    2018)."""
    points = [model.start]
    if starts > 1:
        root = 2.0
        for _ in range(60):
            root = (1.0 + root) ** (1.0 / (len(model.start) + 1.0))
        steps = root ** -np.arange(1.0, len(model.start) + 1.0)
        shares = (0.5 + np.outer(np.arange(1, starts), steps)) % 1.0
        points += list(model.low + shares * (model.high - model.low))
    return min(points, key=lambda point: float(np.sum(model.residuals(point)**2)))


def _settled(least_squares: Callable, model: Model, x: np.ndarray) -> tuple[np.ndarray, bool]:
    """The best parameters near `x`, and whether the search came to its end."""
    for _ in range(MOST_ROUNDS):
        found = least_squares(model.residuals, x, model.jacobian, (model.low, model.high), method="trf", x_scale="jac",
                              ftol=1e-6, xtol=1e-7, gtol=1e-12, max_nfev=MOST_STEPS)
        x = found.x
        model.correct(x)
        # The step that the corrected values ask for, in standard errors, away from the ends of ranges
        jacobian = found.jac[:, found.active_mask == 0]
        step = np.linalg.lstsq(jacobian, model.residuals(x), rcond=None)[0]
        if found.status > 0 and np.linalg.norm(jacobian @ step) < SETTLED:
            return x, True
    return x, False
