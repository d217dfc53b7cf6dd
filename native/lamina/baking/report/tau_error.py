# SPDX-License-Identifier: GPL-3.0-or-later
"""The error of interpolation between rows of thickness: exactly solved slices half-way between two rows, against the
mean of both rows that a linear texture lookup gives."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ...closures.closure_table import LightGrid, view_cosines
from ...common.progress import portions
from ...material.stack import Stack
from ...solver.solve import ScatteringFunction
from ..fit.mixture import norms
from ..fit.row_functions import SolvedAgain, some
from ..fit.slices import SolvedRows, evaluated, shares_of_thickness

# Rows (of 33) after which the half-way slices are tested; denser where layers are thin.
LOOKED_AT = (0, 1, 2, 3, 5, 8, 12, 16, 20, 24, 28, 31)
# Columns of the test, up to the last column for which errors are reported.
COLUMNS = slice(4, 61, 8)
# Shares of the time, measured: half-way solutions, slices of the rows, half-way slices.
TIME = {"solve": 0.2, "known": 0.5, "wanted": 0.3}


def tau_error(solved: SolvedRows, stack: Stack, grid: LightGrid, pool,
              step: Callable[[float, str], None]) -> dict | None:
    """Interpolation error over the thickness of the varying layer of the solved stack; None without such a layer, and
    when not every row was solved.

    `mean` and `worst`: relative L2 error of slices over solid angle, over rows, views and channels; `mirror`: largest
    error of specular reflection or unscattered transmission, relative to all light on that side; `rows`: [thickness,
    mean, worst] half-way in the parameter between two rows; `worst_at`: thickness and view cosine."""
    axis = solved.axis
    varying = stack.varying
    if varying is None or len(solved.rows) < len(axis) or axis[-1] <= 0.0:
        return None
    largest = [stack.optics(varying, c)[1] for c in range(stack.channels)]
    after = sorted({min(k * (len(axis) - 1) // 32, len(axis) - 2) for k in LOOKED_AT})
    middle = shares_of_thickness(axis[-1], np.array(after) + 0.5)
    full = solved.functions[-1]
    rows = sorted({*after, *(k + 1 for k in after)})
    parts = portions(lambda fraction, _: step(fraction, "Measuring between rows of thickness"), TIME)

    def made(number: int) -> ScatteringFunction:
        parts["solve"](number / len(middle), "")
        return full.with_thickness(varying, [middle[number] * tau for tau in largest])

    halves: Sequence[ScatteringFunction] = SolvedAgain(made, range(len(middle)))
    if not isinstance(solved.functions, SolvedAgain):
        halves = list(halves)
    mu = view_cosines()[COLUMNS]
    known = evaluated(some(solved.functions, rows), solved, mu, grid, pool, parts["known"])
    wanted = evaluated(halves, solved, mu, grid, pool, parts["wanted"])
    lower = np.searchsorted(rows, after)

    def between(values):
        return 0.5 * (values[:, lower] + values[:, lower + 1])

    norm = norms(wanted.values, grid)
    errors = norms(between(known.values) - wanted.values, grid) / np.where(norm > 0.0, norm, np.inf)
    light = wanted.whole
    mirror = np.abs(between(known.direct) - wanted.direct) / np.where(light > 0.0, light, np.inf)
    by_row = np.moveaxis(errors, 1, 0).reshape(len(after), -1)
    # Half-way slices are denser where layers are thin; the mean gives each pair of rows the same weight.
    mean = np.interp(np.arange(len(axis) - 1), after, by_row.mean(axis=1)).mean()
    _, row, _, column = np.unravel_index(int(errors.argmax()), errors.shape)
    taus = [float(share * axis[-1]) for share in middle]
    return {
        "mean": float(mean),
        "worst": float(errors.max()),
        "worst_at": {"tau": taus[row], "mu_o": float(mu[column])},
        "mirror": float(mirror.max()),
        "rows": [[tau, float(one.mean()), float(one.max())] for tau, one in zip(taus, by_row, strict=True)],
    }
