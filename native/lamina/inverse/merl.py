# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured materials of MERL (.binary): Matusik, Pfister, Brand and McMillan 2003."""

from __future__ import annotations

import itertools
import os
from pathlib import Path

import numpy as np

from ..common.errors import MeasurementError
from .directions import Directions

SHAPE = (90, 90, 180)  # theta of the half vector, theta and azimuth of the difference
# Factors of the stored numbers, by channel: red, green, blue.
SCALES = np.array([1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0])
SMALLEST = 1e-7  # 1/sr, in place of 0 in a logarithm
# Noise is reduced over neighbours along the angle of the difference and its azimuth, which has more cells than a table.
SMOOTHED = ((1, (0.5, 0.25)), (2, (0.36, 0.24, 0.08)))
LEAST_KNOWN = 0.3  # share of the cells about a place that must have values


def read_merl(path: str | os.PathLike) -> Directions:
    """All directions above the horizon for which the file has values, at the centres of its cells. Raises
    MeasurementError and OSError."""
    values = _values(path)
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


def merl_at(path: str | os.PathLike, h: np.ndarray, d: np.ndarray, c: np.ndarray, *_: np.ndarray) -> np.ndarray:
    """The values in 1/sr, (*h.shape, 3), at half vectors, see half_table, as means over neighbouring cells; nan where
    the file has none. Raises MeasurementError and OSError."""
    values = _values(path)
    if np.any(np.isnan(values)) or np.any(np.isinf(values)):
        raise MeasurementError(f"{path}: holds values that are not finite")
    # The same after half a turn, an exchange of both directions, and mirrored: c is that of four azimuths, of which
    # the file has two.
    known = (values >= 0.0) & (values[:, :, ::-1] >= 0.0)
    logarithm = np.log(np.maximum(np.where(known, 0.5 * (values + values[:, :, ::-1]), 1.0), SMALLEST))
    for axis, weights in SMOOTHED:
        logarithm = _mean(logarithm, known, axis, weights)
    places = (np.sqrt(np.degrees(h) * 90.0) - 0.5, np.degrees(d) - 0.5, np.degrees(np.arccos(c)) - 0.5)
    total, whole = np.zeros((*h.shape, 3)), np.zeros((*h.shape, 1))
    for corner in itertools.product((0, 1), repeat=3):
        weight, index = np.ones(h.shape), []
        for place, size, above in zip(places, SHAPE, corner, strict=True):
            place = np.clip(place, 0.0, size - 1.0)
            first = np.minimum(place.astype(int), size - 2)
            weight = weight * (place - first if above else 1.0 - place + first)
            index.append(first + above)
        seen = np.all(known[tuple(index)], axis=-1)
        total += np.where(seen, weight, 0.0)[..., None] * logarithm[tuple(index)]
        whole += np.where(seen, weight, 0.0)[..., None]
    return np.where(whole > LEAST_KNOWN, np.exp(total / np.maximum(whole, 1e-300)), np.nan)


def _mean(values: np.ndarray, known: np.ndarray, axis: int, weights: tuple[float, ...]) -> np.ndarray:
    """Means over neighbours along an axis, of those that are known; `weights`: of the cell and the next ones."""
    values, known = np.moveaxis(values, axis, 0), np.moveaxis(known, axis, 0)
    total, whole = weights[0] * np.where(known, values, 0.0), weights[0] * known.astype(float)
    for distance, weight in enumerate(weights[1:], 1):
        for to, of in ((slice(distance, None), slice(-distance)), (slice(-distance), slice(distance, None))):
            total[to] += weight * np.where(known[of], values[of], 0.0)
            whole[to] += weight * known[of]
    return np.moveaxis(total / np.maximum(whole, 1e-300), 0, axis)


def _values(path: str | os.PathLike) -> np.ndarray:
    data = Path(path).read_bytes()
    count = int(np.prod(SHAPE))
    if len(data) != 12 + 24 * count or tuple(np.frombuffer(data, "<i4", 3).tolist()) != SHAPE:
        raise MeasurementError(f"{path}: must be a .binary file of MERL, three numbers {SHAPE} and 3 x {count} values")
    return np.moveaxis(np.frombuffer(data, "<f8", 3 * count, 12).reshape(3, *SHAPE), 0, -1) * SCALES
