# SPDX-License-Identifier: GPL-3.0-or-later
"""The light that enters a surface, by direction, as a Diffuse and a Toon closure of Cycles."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..closures.lobes import toon

SIZES, SMOOTHS = np.linspace(0.1, 0.9, 17), np.linspace(0.1, 0.9, 9)
_NODES, _WEIGHTS = (0.5 * part for part in np.polynomial.legendre.leggauss(64))
COSINES = _NODES + 0.5  # incidence cosines of the fit
AZIMUTHS = 64
ENOUGH = 0.02  # error of a Diffuse closure alone, relative to all light, that saves the Toon closure's two rays


class EntryLobes(NamedTuple):
    """Colours of a Diffuse and a Toon closure by channel, which together reflect all light; `size` and `smooth` of the
    Toon closure; `error`: root mean square difference from the function over solid angle, relative to the function's,
    the largest over channels."""

    diffuse: np.ndarray
    toon: np.ndarray
    size: float
    smooth: float
    error: float


def mean(entering: np.ndarray) -> np.ndarray:
    """Mean over Lambertian light of values at COSINES, shape (64,) or (64, channels)."""
    return 2.0 * (_WEIGHTS * COSINES) @ entering


def fit(entering: np.ndarray, share: np.ndarray, tilts: np.ndarray, weights: np.ndarray) -> EntryLobes:
    """Closures with the directions of `entering`: light that enters at COSINES, as a share of the incident light, shape
    (64, channels). Only the dependence on direction counts: the closures together reflect all light. A channel without
    light gets closures for Lambert light. `share`, (channels,): share of this light in all light of the surface. The
    Diffuse closure is tilted by angles with the tangents `tilts`, (n,), with the probabilities `weights`, (n,
    channels)."""
    entering = np.where(np.any(entering > 0.0, axis=0), entering, 1.0)
    wanted = entering / mean(entering) * COSINES[:, None] / np.pi  # times the cosine, like closures
    flat, of_flat = _scaled(np.stack([_tilted(tilt) for tilt in tilts], axis=1) @ weights)
    alone, none = _error(wanted, wanted - flat), np.zeros(len(of_flat))
    if np.max(alone * share) < ENOUGH:
        return EntryLobes(1.0 / of_flat, none, float(SIZES[0]), float(SMOOTHS[0]), float(np.max(alone)))
    found = []
    for size in SIZES:
        for smooth in SMOOTHS[size + SMOOTHS <= 1.0 + 1e-9]:
            lobe = toon(float(size), float(smooth))
            cone, of_cone = _scaled(np.asarray(lobe.evaluate(np.ones_like(COSINES), COSINES, 0.0 * COSINES), float))
            # Shares 1 - w and w of the light; least squares for w, clamped to [0, 1].
            apart = cone[:, None] - flat
            square = _WEIGHTS @ apart**2
            of_toon = np.clip(_WEIGHTS @ (apart * (wanted - flat)) / square, 0.0, 1.0)
            error = float(np.max(_error(wanted, wanted - flat - apart * of_toon)))
            found.append(EntryLobes((1.0 - of_toon) / of_flat, of_toon / of_cone, float(size), float(smooth), error))
    return min(found, key=lambda one: one.error)


def _tilted(tilt: float) -> np.ndarray:
    """Cycles' Diffuse closure times the cosine at COSINES, for a normal tilted by the tangent `tilt`: the mean over
    azimuths. No light comes from below the surface. Without Cycles' bump map correction."""
    azimuths = (np.arange(AZIMUTHS) + 0.5) * np.pi / AZIMUTHS
    along = COSINES[:, None] + tilt * np.sqrt(1.0 - COSINES**2)[:, None] * np.cos(azimuths)
    return np.mean(np.maximum(along, 0.0), axis=1) / (math.pi * math.sqrt(1.0 + tilt**2))


def _error(wanted: np.ndarray, left: np.ndarray) -> np.ndarray:
    """Root mean square of `left` over solid angle, relative to that of `wanted`, by channel."""
    return np.sqrt(_WEIGHTS @ left**2 / (_WEIGHTS @ wanted**2))


def _scaled(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(closures times the cosine at COSINES, in the first axis, scaled to reflect all light; the light that they
    reflect without that scale)."""
    whole = 2.0 * np.pi * (_WEIGHTS @ values)
    return values / whole, whole
