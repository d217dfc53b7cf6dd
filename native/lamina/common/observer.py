# SPDX-License-Identifier: GPL-3.0-or-later
"""The CIE 1931 standard observer: spectra as linear Rec. 709."""

from __future__ import annotations

import csv
from functools import cache
from importlib.resources import files

import numpy as np

from .srgb import LUMINANCE

PRIMARIES = np.array([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]])  # x, y of R, G and B: Rec. ITU-R BT.709

# Least share of the luminance that a channel of a table has. It is not 0, because errors of a channel are relative to
# its own light.
LEAST = 0.01


@cache
def rec709_of_d65() -> tuple[np.ndarray, np.ndarray]:
    """(wavelengths in nm, 380 to 780 in steps of 5; linear Rec. 709 of a surface under D65 that reflects one of these
    wavelengths only, shape (3, 81)). D65 is the white of Rec. 709, so each row has the sum 1."""
    wavelengths, x, y, z, d65 = _table()
    weights = np.array([x, y, z]) * d65
    # XYZ of the primaries in the columns, each scaled so that R = G = B = 1 is the white of D65.
    xyz = np.array([PRIMARIES[:, 0], PRIMARIES[:, 1], 1.0 - PRIMARIES.sum(axis=1)]) / PRIMARIES[:, 1]
    primaries = xyz * np.linalg.solve(xyz, weights.sum(axis=1))
    return wavelengths, np.linalg.solve(primaries, weights)


@cache
def rec709_of(wavelengths: tuple[float, ...]) -> np.ndarray:
    """The matrix, shape (3, n), from reflectances at these wavelengths in nm to linear Rec. 709 under D65, with
    reflectances that are linear between the wavelengths and constant beyond. Each row has the sum 1."""
    every, rows = rec709_of_d65()
    order = np.argsort(wavelengths)
    shares = [np.interp(every, np.array(wavelengths)[order], one) for one in np.eye(len(wavelengths))[:, order]]
    return rows @ np.array(shares).T


def rec709(values: np.ndarray, wavelengths: tuple[float, ...], axis: int = -1) -> np.ndarray:
    """Values by wavelength along `axis` as red, green and blue, not clipped."""
    return np.moveaxis(np.tensordot(rec709_of(wavelengths), values, (1, axis)), 0, axis)


def fading(rgb: np.ndarray, axis: int) -> np.ndarray:
    """The least share of the way to the gray of the same luminance on which no channel is below LEAST of the luminance:
    0 for colours well inside the gamut. One number for each colour along `axis`, whose length becomes 1."""
    gray = luminance(rgb, axis)
    missing = LEAST * gray - rgb
    shares = np.divide(missing, gray - rgb, out=np.zeros_like(rgb), where=missing > 0.0)
    return np.clip(shares.max(axis=axis, keepdims=True), 0.0, 1.0)


def faded(rgb: np.ndarray, share: np.ndarray, axis: int) -> np.ndarray:
    """Colours moved by a share of the way to the gray of their luminance."""
    return rgb + share * (luminance(rgb, axis) - rgb)


def luminance(rgb: np.ndarray, axis: int) -> np.ndarray:
    """The luminance of linear Rec. 709 along `axis`, whose length becomes 1."""
    return np.expand_dims(np.moveaxis(rgb, axis, -1) @ LUMINANCE, axis)


def _table() -> np.ndarray:
    lines = (files(__package__) / "cie_1931_d65.csv").read_text(encoding="utf-8").splitlines()
    rows = list(csv.reader(line for line in lines if not line.startswith("#")))[1:]
    return np.array([[float(cell) for cell in row] for row in rows]).T
