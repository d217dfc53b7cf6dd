# SPDX-License-Identifier: GPL-3.0-or-later
"""The smoothest spectrum that has given red, green and blue values: S. A. Burns, Numerical methods for smoothest
reflectance reconstruction, Color Research & Application 45, 8 (2020)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from ..common.observer import rec709_of
from ..kinds.fields import Field

EXACT = 1e-9  # largest error of red, green and blue, of the largest, where a search ends
LEAST = 1e-4  # the least value, of the largest, and the distance of shares from 1
LONGEST, FARTHEST, MOST_STEPS = 1.0, 12.0, 400  # of the steps of a search


def smoothest(rgb: Sequence[float], wavelengths: Sequence[float], field: Field) -> tuple[float, ...]:
    """The values at `wavelengths` (nm) of a quantity with these red, green and blue values, linear Rec. 709 under D65.

    The squares of differences between neighbours are least: of atanh(2 v - 1) for shares, of log v for other quantities
    that are not negative, and of v itself. Spectra thus stay in the range of the quantity. Colours that no spectrum in
    this range has become the nearest that one has."""
    if rgb[0] == rgb[1] == rgb[2]:
        return (rgb[0],) * len(wavelengths)
    law = "linear" if field.low < 0.0 else "share" if field.high <= 1.0 else "positive"
    values = _smoothest(tuple(rgb), tuple(wavelengths), law)
    return tuple(float(value) for value in np.clip(values, field.low, field.high))


@lru_cache(maxsize=256)
def _smoothest(rgb: tuple[float, ...], wavelengths: tuple[float, ...], law: str) -> np.ndarray:
    """Newton's steps for the least slopes under the condition of the three values, by multipliers of Lagrange. The
    curvature of the condition is left out, so steps lead to smaller slopes from any start."""
    scale = 1.0 if law == "share" else max(map(abs, rgb))
    wanted = np.array(rgb) / scale
    order = np.argsort(wavelengths)
    rows, slopes = rec709_of(tuple(wavelengths))[:, order], np.diff(np.eye(len(wavelengths)), axis=0)
    value, slope, start = _LAWS[law]
    z = np.full(len(wavelengths), start(np.clip(wanted.mean(), LEAST, 1.0 - LEAST)))
    bent = slopes.T @ slopes + 1e-9 * np.eye(len(z))
    for number in range(MOST_STEPS):
        longest = LONGEST / (1.0 + 0.1 * number)  # so that steps for saturated colours cannot run in a circle
        error, condition = wanted - rows @ value(z), rows * slope(z)
        system = np.block([[bent, condition.T], [condition, np.zeros((3, 3))]])
        step = np.linalg.lstsq(system, np.concatenate([-bent @ z, error]), rcond=1e-14)[0][:len(z)]
        z = np.clip(z + step * min(1.0, longest / np.abs(step).max()), -FARTHEST, FARTHEST)
        if np.abs(error).max() < EXACT and np.abs(step).max() < 1e-6:
            break
    found = np.empty_like(z)
    found[order] = value(z)
    return scale * found


_LAWS: dict = {
    "share": (lambda z: 0.5 + 0.5 * np.tanh(z), lambda z: 0.5 / np.cosh(z) ** 2, lambda v: np.arctanh(2.0 * v - 1.0)),
    "positive": (np.exp, np.exp, np.log),
    "linear": (lambda z: z, np.ones_like, lambda v: v),
}
