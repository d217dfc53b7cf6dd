# SPDX-License-Identifier: GPL-3.0-or-later
"""The light that enters a surface, by direction, as a Diffuse and a Toon closure of Cycles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..closures.lobes import diffuse, toon

SIZES, SMOOTHS = np.linspace(0.1, 0.9, 17), np.linspace(0.1, 0.9, 9)
_NODES, _WEIGHTS = (0.5 * part for part in np.polynomial.legendre.leggauss(64))
COSINES = _NODES + 0.5  # incidence cosines of the fit


class EntryLobes(NamedTuple):
    """Colours of a Diffuse and a Toon closure by channel, which together reflect all light; `size` and `smooth` of the
    Toon closure; `error`: root mean square difference from the function over solid angle, relative to the function's,
    the largest over channels."""

    diffuse: np.ndarray
    toon: np.ndarray
    size: float
    smooth: float
    error: float


def fit(entering: np.ndarray) -> EntryLobes:
    """Closures with the directions of `entering`: light that enters at COSINES, as a share of the incident light, shape
    (64, channels). Only the dependence on direction counts: the closures together reflect all light. A channel without
    light gets the Diffuse closure."""
    entering = np.where(np.any(entering > 0.0, axis=0), entering, 1.0)
    mean = 2.0 * (_WEIGHTS * COSINES) @ entering
    wanted = entering / mean * COSINES[:, None] / np.pi  # times the cosine, like closures
    flat, _ = _lobe(diffuse())
    found = []
    for size in SIZES:
        for smooth in SMOOTHS[size + SMOOTHS <= 1.0 + 1e-9]:
            cone, whole = _lobe(toon(float(size), float(smooth)))
            # Shares 1 - w and w of the light; least squares for w, clamped to [0, 1].
            apart = cone - flat
            square = np.sum(_WEIGHTS * apart**2)
            share = np.clip((_WEIGHTS * apart) @ (wanted - flat[:, None]) / square, 0.0, 1.0)
            left = wanted - flat[:, None] - apart[:, None] * share
            error = float(np.sqrt(np.max(_WEIGHTS @ left**2 / (_WEIGHTS @ wanted**2))))
            found.append(EntryLobes(1.0 - share, share / whole, float(size), float(smooth), error))
    return min(found, key=lambda one: one.error)


def _lobe(lobe) -> tuple[np.ndarray, float]:
    """(closure times the cosine at COSINES, for a view along the normal, scaled to reflect all light; the light that
    the closure reflects without that scale)."""
    values = np.asarray(lobe.evaluate(np.ones_like(COSINES), COSINES, np.zeros_like(COSINES)), float)
    whole = float(2.0 * np.pi * np.sum(_WEIGHTS * values))
    return values / whole, whole
