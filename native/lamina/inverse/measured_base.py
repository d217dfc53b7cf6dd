# SPDX-License-Identifier: GPL-3.0-or-later
"""A measured material as the base of a stack."""

from __future__ import annotations

import os
import warnings

import numpy as np

from ..common.arguments import check_path
from ..common.errors import MeasurementError
from ..kinds.bases import Measured
from ..material import half_table
from .merl import merl_at
from .rgl import rgl_at

# A table reflects at most this share of a beam: the solver's sums err by some 1e-4.
MOST = 0.999
COSINES = np.array([0.02, 0.04, 0.06, 0.08, 0.1, 0.13, 0.17, 0.22, 0.28, 0.35, 0.45, 0.55, 0.7, 0.85, 1.0])


def load_base(path: str | os.PathLike, name: str | None = None) -> Measured:
    """The material in a file as a base: `.binary` of MERL, or an isotropic `.bsdf` of RGL, whose spectra become red,
    green and blue under daylight. `name`: a text for the user, or None for that of the file.

    The base holds its own table of some 210 kilobytes (grey: 70), and needs the file no more. Values are means over an
    exchange of view and light. Data that reflect more light than they receive, as measurements at grazing angles do,
    are scaled down until they reflect 99.9 %, and a warning tells by how much. Raises MeasurementError for a file that
    cannot be read, and OSError."""
    return read_base(path, name)[0]


def read_base(path: str | os.PathLike, name: str | None = None) -> tuple[Measured, float]:
    """(the base of load_base, the largest share of a beam that the data reflect). Warns and raises as load_base."""
    path = check_path(path)
    suffix = path.suffix.lower()
    if suffix not in (".binary", ".bsdf"):
        raise MeasurementError(f"{path}: unknown format: a measured base must be .binary (MERL) or .bsdf (RGL)")
    values = (merl_at if suffix == ".binary" else rgl_at)(path, *half_table.knots())
    if np.all(np.isnan(values)):
        raise MeasurementError(f"{path}: has no values")
    table, largest = conserving(half_table.table_from(_alike(values)))
    if largest > MOST:
        warnings.warn(f"{path}: the data reflect up to {largest:.4g} times the light that they receive, and are scaled "
                      f"down there to {MOST:g}", stacklevel=3)
    return Measured(half_table.text_from(table), path.stem if name is None else name), largest


def conserving(table: np.ndarray) -> tuple[np.ndarray, float]:
    """(a table that reflects at most MOST of each beam, the largest share that the given table reflects). Values are
    multiplied by a factor at each of both directions, so that the table stays reciprocal."""
    *_, mu_o, mu_i = half_table.knots()
    found = half_table.albedos(table, COSINES)
    largest = float(found.max())
    change = np.zeros((len(COSINES), table.shape[-1]))
    for _ in range(12):
        if found.max() <= MOST:
            break
        change += 0.5 * np.log(np.minimum(1.0, (MOST - 1e-4) / found))
        factors = np.stack([np.interp(mu_o, COSINES, one) + np.interp(mu_i, COSINES, one) for one in change.T], -1)
        found = half_table.albedos(table + factors, COSINES)
    else:
        factors = factors + np.log(MOST / found.max())
    return (table if largest <= MOST else table + factors), largest


def _alike(values: np.ndarray) -> np.ndarray:
    """One channel in place of channels that are equal within rounding."""
    return values[..., :1] if np.allclose(values, values[..., :1], rtol=1e-5, atol=0.0, equal_nan=True) else values
