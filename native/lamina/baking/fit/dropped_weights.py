# SPDX-License-Identifier: GPL-3.0-or-later
"""Weights that are too small for Cycles.

Cycles drops a closure where the mean of its weight over R, G and B is below 1e-5. Such weights are moved to the other
closures of the same view, so the directional albedo of the rendered mixture stays exact."""

from __future__ import annotations

import numpy as np

from ...closures.closure_table import LightGrid
from .mixture import Mixture, albedos_of, reweighted
from .slices import Slices

# Cycles' CLOSURE_WEIGHT_CUTOFF is 1e-5. Between a texel with a weight and one without, interpolation passes through all
# smaller values. The larger the least weight, the shorter the range in which Cycles drops the closure.
LEAST_WEIGHT = 2e-5


def folded(mixture: Mixture, wanted: Slices, grid: LightGrid, mixed: bool,
           factor: np.ndarray | None = None) -> Mixture:
    """The mixture without weights that Cycles would drop, its errors measured again. `factor` [side, row, channel,
    column] multiplies the weights before Cycles sees them."""
    shown = mixture.weights * (1.0 if factor is None else factor[:, None])
    if not np.any(_too_small(shown)):
        return mixture
    albedo = albedos_of(mixture, grid, mixed)[:, :, :, None]
    weights, shown = mixture.weights.copy(), shown.copy()
    for _ in mixture.closures:
        small = _too_small(shown)
        least = np.where(small, shown.mean(axis=3), np.inf).argmin(axis=1)[:, None]
        goes = small & (np.arange(len(mixture.closures))[None, :, None, None] == least)
        _fold(weights, goes, albedo)
        shown = weights * (1.0 if factor is None else factor[:, None])
        if not np.any(_too_small(shown)):
            break
    return reweighted(mixture, weights, wanted, grid, mixed)


def _too_small(weights: np.ndarray) -> np.ndarray:
    """[side, closure, row, column]: true where Cycles would drop a closure and another closure can take its light."""
    mean = weights.mean(axis=3)
    return (mean > 0.0) & (mean < LEAST_WEIGHT) & ((mean > 0.0).sum(axis=1, keepdims=True) > 1)


def _fold(weights: np.ndarray, goes: np.ndarray, albedo: np.ndarray) -> None:
    """Sets the weights of the closures `goes` [side, closure, row, column] to 0, in place. The others grow in
    proportion; in a channel where they are black, the strongest closure takes all."""
    before = (weights * albedo).sum(axis=1, keepdims=True)
    weights[np.broadcast_to(goes[:, :, :, None], weights.shape)] = 0.0
    light = weights * albedo
    after = light.sum(axis=1, keepdims=True)
    seen = after > 1e-3 * before
    weights *= np.where(seen, before / np.where(seen, after, 1.0), 1.0)
    strongest = light.mean(axis=3, keepdims=True).argmax(axis=1)[:, None]
    takes = np.arange(weights.shape[1])[None, :, None, None, None] == strongest
    weights += takes * np.where(seen, 0.0, before - after) / np.where(albedo > 0.0, albedo, np.inf)
