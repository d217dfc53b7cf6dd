# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured materials of MERL (.binary): Matusik, Pfister, Brand and McMillan 2003."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from ..common.errors import MeasurementError
from .directions import Directions

SHAPE = (90, 90, 180)  # theta of the half vector, theta and azimuth of the difference
# Factors of the stored numbers, by channel: red, green, blue.
SCALES = np.array([1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0])


def read_merl(path: str | os.PathLike) -> Directions:
    """All directions above the horizon for which the file has values, at the centres of its cells. Raises
    MeasurementError and OSError."""
    data = Path(path).read_bytes()
    count = int(np.prod(SHAPE))
    if len(data) != 12 + 24 * count or tuple(np.frombuffer(data, "<i4", 3).tolist()) != SHAPE:
        raise MeasurementError(f"{path}: must be a .binary file of MERL, three numbers {SHAPE} and 3 x {count} values")
    values = np.moveaxis(np.frombuffer(data, "<f8", 3 * count, 12).reshape(3, *SHAPE), 0, -1) * SCALES
    half = np.radians((np.arange(90) + 0.5)**2 / 90.0)  # cells are denser about the mirror direction
    theta, azimuth = np.radians(np.arange(90) + 0.5), np.radians(np.arange(180) + 0.5)
    half, theta, azimuth = (one.ravel() for one in np.meshgrid(half, theta, azimuth, indexing="ij"))
    # The incoming direction about the half vector, turned with the half vector into the plane of x and z
    x, y, z = np.sin(theta) * np.cos(azimuth), np.sin(theta) * np.sin(azimuth), np.cos(theta)
    wi = np.stack([np.cos(half) * x + np.sin(half) * z, y, np.cos(half) * z - np.sin(half) * x], axis=-1)
    m = np.stack([np.sin(half), np.zeros_like(half), np.cos(half)], axis=-1)
    found = Directions.of_vectors(wi, 2.0 * z[:, None] * m - wi, values.reshape(-1, 3))
    # The files mark directions without a measurement by negative numbers.
    return found.where(np.all((found.values >= 0.0) | np.isnan(found.values), axis=-1))
