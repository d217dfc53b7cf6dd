# SPDX-License-Identifier: GPL-3.0-or-later
"""Least squares within ranges by numpy alone: Blender has no scipy."""

from __future__ import annotations

import math

import numpy as np

from ..common.errors import SolveError
from .model import Model

MOST_STEPS, MOST_TRIES = 15, 5
SETTLED = 2e-3  # a step that reduces the sum of squares by a smaller share is the last


def descend(model: Model, x: np.ndarray) -> tuple[np.ndarray, float]:
    """(parameters, sum of squares) to which damped Gauss-Newton steps lead from `x` (Marquardt 1963). Parameters at an
    end of their range to which the step would push them stay there. Raises SolveError where the start cannot be solved,
    and what the model raises to cancel."""
    damping = 1e-2
    away = model.residuals(x)
    least = float(away @ away)
    for _ in range(MOST_STEPS):
        jacobian = model.jacobian(x)
        downhill = -(jacobian.T @ away)
        free = ~(((x <= model.low) & (downhill < 0.0)) | ((x >= model.high) & (downhill > 0.0)))
        if not np.any(free):
            break
        square = jacobian[:, free].T @ jacobian[:, free]
        scale = np.maximum(np.diag(square), 1e-12 * max(float(np.max(np.diag(square))), 1e-300))
        before = least
        for _ in range(MOST_TRIES):
            step = np.zeros_like(x)
            step[free] = np.linalg.solve(square + np.diag(damping * scale), downhill[free])
            tried = np.clip(x + step, model.low, model.high)
            try:
                found = model.residuals(tried)
            except SolveError:  # a shorter step may stay where stacks can be solved
                found = np.full_like(away, math.inf)
            if float(found @ found) < least:
                x, away, least = tried, found, float(found @ found)
                damping = max(damping / 5.0, 1e-6)
                break
            damping *= 6.0
        if not least < (1.0 - SETTLED) * before:
            break
    return x, least
