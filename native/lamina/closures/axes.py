# SPDX-License-Identifier: GPL-3.0-or-later
"""The axes of a lookup table: view angles by column, thicknesses of a varying layer by row."""

from __future__ import annotations

import math

import numpy as np

from ..kinds.table import COLUMNS, TAU_BEND, TAU_ROWS


def column_angles() -> np.ndarray:
    """View angles theta_o of the columns in radians, shape (64,): from the normal to grazing."""
    return np.linspace(0.0, 0.5 * math.pi, COLUMNS)


def tau_rows(largest: float, count: int = TAU_ROWS) -> np.ndarray:
    """Thicknesses of a varying layer's rows, shape (count,): uniform in t = tau / (tau + TAU_BEND), the last
    row at `largest`."""
    rows = tau_at(largest, np.arange(count), count)
    rows[-1] = largest
    return rows


def tau_at(largest: float, rows: np.ndarray, count: int = TAU_ROWS) -> np.ndarray:
    """Thickness at `rows` of that axis, integers or fractions between two rows."""
    t = largest / (largest + TAU_BEND) * np.asarray(rows, float) / (count - 1)
    return TAU_BEND * t / (1.0 - t)
