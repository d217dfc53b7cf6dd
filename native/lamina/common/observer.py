# SPDX-License-Identifier: GPL-3.0-or-later
"""The CIE 1931 standard observer: spectra of reflectance as linear Rec. 709 under an illuminant."""

from __future__ import annotations

import csv
from functools import cache
from importlib.resources import files

import numpy as np

from ..kinds.spectra import D65, ILLUMINANT, POWER, Spectrum, check_wavelengths
from .arguments import check_whole
from .errors import ArgumentError, StackError, quoted
from .srgb import LUMINANCE

PRIMARIES = np.array([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]])  # x, y of R, G and B: Rec. ITU-R BT.709

# Least share of the luminance that a channel of a table has. It is not 0, because errors of a channel are relative to
# its own light.
LEAST = 0.01


# Of XYZ, to the responses in which Bradford's transform scales one white to another (Lam 1985).
BRADFORD = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])


@cache
def rec709_under(illuminant: str | Spectrum = D65) -> tuple[np.ndarray, np.ndarray]:
    """(wavelengths in nm, 380 to 780 in steps of 5; linear Rec. 709 of a surface under `illuminant` that reflects one
    of these wavelengths only, shape (3, 81)). A white surface is white under each illuminant, by Bradford's transform
    of its white to D65, the white of Rec. 709: each row has the sum 1."""
    wavelengths, x, y, z, d65, a, led = _table()
    if isinstance(illuminant, Spectrum):
        light = _light(illuminant, wavelengths)
    else:
        light = {D65: d65, "A": a, "E": np.ones_like(d65), "LED": led}[illuminant]
    weights = np.array([x, y, z]) * light
    if illuminant != D65:
        white, wanted = (BRADFORD @ (np.array([x, y, z]) @ one) for one in (light, d65 * (y @ light) / (y @ d65)))
        weights = np.linalg.solve(BRADFORD, (wanted / white)[:, None] * (BRADFORD @ weights))
    # XYZ of the primaries in the columns, each scaled so that R = G = B = 1 is the white of D65.
    xyz = np.array([PRIMARIES[:, 0], PRIMARIES[:, 1], 1.0 - PRIMARIES.sum(axis=1)]) / PRIMARIES[:, 1]
    primaries = xyz * np.linalg.solve(xyz, weights.sum(axis=1))
    return wavelengths, np.linalg.solve(primaries, weights)


def _light(lamp: Spectrum, wavelengths: np.ndarray) -> np.ndarray:
    """The light of a lamp at equidistant wavelengths, between which the observer is linear: the mean over the hat
    function of each, by the trapezoidal rule at these and the lamp's own wavelengths. Lamps may have narrow lines."""
    step = wavelengths[1] - wavelengths[0]
    own = [one for one in lamp.wavelengths if wavelengths[0] - step < one < wavelengths[-1] + step]
    every = np.unique([wavelengths[0] - step, *wavelengths, wavelengths[-1] + step, *own])
    power = np.array([lamp.at(one) for one in every]).real * np.gradient(every)  # widths; no hat reaches the ends
    return np.maximum(1.0 - np.abs(wavelengths[:, None] - every) / step, 0.0) @ power / step


def checked_illuminant(given) -> str | Spectrum:
    """The illuminant, checked. Raises StackError."""
    if not isinstance(given, Spectrum):
        return ILLUMINANT.check(given, ILLUMINANT.name)
    lamp = given.checked(POWER, ILLUMINANT.name)
    wavelengths, _, y, *_ = _table()
    if not y @ _light(lamp, wavelengths) > 0.0:
        raise StackError("illuminant.values: must not all be 0 from 380 to 780 nm, where the eye sees")
    return lamp


@cache
def rec709_of(wavelengths: tuple[float, ...], illuminant: str | Spectrum = D65) -> np.ndarray:
    """The matrix, shape (3, n), from reflectances at these wavelengths in nm to linear Rec. 709 under an illuminant,
    with reflectances that are linear between the wavelengths and constant beyond. Each row has the sum 1. Raises
    StackError."""
    every, rows = rec709_under(checked_illuminant(illuminant))
    order = np.argsort(wavelengths)
    shares = [np.interp(every, np.array(wavelengths)[order], one) for one in np.eye(len(wavelengths))[:, order]]
    return rows @ np.array(shares).T


def rec709(values: np.ndarray, wavelengths: tuple[float, ...], axis: int = -1,
           illuminant: str | Spectrum = D65) -> np.ndarray:
    """Reflectances, or other factors of light, by wavelength in nm along `axis`, as linear Rec. 709 under an
    illuminant, see Stack. White surfaces are white; colours are not clipped. Raises StackError, ArgumentError."""
    wavelengths = check_wavelengths(wavelengths)
    try:
        values = np.asarray(values, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError(f"values = {quoted(values)}: must be an array of numbers") from None
    if values.ndim > 0:
        check_whole(axis, "axis", -values.ndim, values.ndim - 1)
    if values.ndim == 0 or values.shape[axis] != len(wavelengths):
        raise ArgumentError(f"values has the shape {values.shape}: must have {len(wavelengths)} values along axis "
                            f"{axis}, as many as wavelengths")
    return np.moveaxis(np.tensordot(rec709_of(wavelengths, checked_illuminant(illuminant)), values, (1, axis)), 0, axis)


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


def in_gamut(rgb: np.ndarray, axis: int) -> np.ndarray:
    """Colours along `axis`, each faded as far as it needs."""
    return faded(rgb, fading(rgb, axis), axis)


def luminance(rgb: np.ndarray, axis: int) -> np.ndarray:
    """The luminance of linear Rec. 709 along `axis`, whose length becomes 1."""
    return np.expand_dims(np.moveaxis(rgb, axis, -1) @ LUMINANCE, axis)


def _table() -> np.ndarray:
    lines = (files(__package__) / "cie_1931.csv").read_text(encoding="utf-8").splitlines()
    rows = list(csv.reader(line for line in lines if not line.startswith("#")))[1:]
    return np.array([[float(cell) for cell in row] for row in rows]).T
