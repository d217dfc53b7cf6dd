# SPDX-License-Identifier: GPL-3.0-or-later
"""The light through the portal by view and by depth of the source.

Light that enters at a grazing angle stays near the surface, so a curved surface changes this light less. In a deep
medium, the collision with which the portal's light begins has a known density over depth for each view. The sources
belong to these collisions in the order of depth: quantiles of the two distributions of light correspond. Mean depths
of collisions and sources tell how curved surfaces change the light."""

from __future__ import annotations

import numpy as np

from .first_orders import FirstOrders
from .later_flights import escape
from .single_scattering import SingleScattering
from .source_depths import Sources

STRONG = 0.75  # of what p exceeds 1 by, for strong curvature
DEEPEST = 1e-9  # densities below this part of the largest are too small for a quotient


def shares_and_curved(first: FirstOrders | None, sources: Sources, cosines: np.ndarray) -> tuple[np.ndarray, float]:
    """(weight of a source by view cosine and depth, shape (cosines, depths, channels), for light that enters at
    `cosines`; exponent p of lamina.subsurface.portal, the mean over channels). The mean of the weights over depths is
    1. Without the orders `first`, all views have the weights of `sources`, and p is 0."""
    if first is None:
        return np.repeat(sources.shares[None], len(cosines), axis=0), 0.0
    depths, weights, density = first.next_collision(np.append(cosines, 1.0))
    light = (weights * density[:, -1])[:, None] * _escaping(first.medium, depths)
    collision = depths @ light / np.sum(light, axis=0) / first.medium.extinction
    return _shares(sources.shares, depths, light, density), _curved(sources, collision)


def _shares(of_depth: np.ndarray, depths: np.ndarray, light: np.ndarray, density: np.ndarray) -> np.ndarray:
    """The weights: quotients of the `density` of collisions for each view and that along the normal, the last."""
    result = np.empty((density.shape[1] - 1, *of_depth.shape))
    for c in range(of_depth.shape[1]):
        at = np.interp(_ranks(of_depth[:, c]), _ranks(light[:, c]), depths)  # depth of the collision for each source
        by_view = np.stack([np.interp(at, depths, column) for column in density.T])
        result[:, :, c] = of_depth[:, c] * by_view[:-1] / np.maximum(by_view[-1], DEEPEST * by_view[-1].max())
    return result / np.maximum(result.mean(axis=1, keepdims=True), DEEPEST)


def _curved(sources: Sources, collision: np.ndarray) -> float:
    """The exponent p, at least 1, from the mean depth of the light's `collision`, mm, (channels,)."""
    source = np.mean(sources.shares * sources.depths[:, None], axis=0)
    exact = 3.0 - 2.0 * float(np.mean(collision / source))  # to first order in the curvature
    return 1.0 + STRONG * max(exact - 1.0, 0.0)


def _escaping(medium: SingleScattering, depths: np.ndarray) -> np.ndarray:
    """Light that leaves, of light that collides at `depths`, shape (depths, channels). Isotropic scattering with the
    transport albedo stands for the phase function."""
    albedo = medium.sigma_s / medium.extinction
    found = escape(np.zeros(1), (1.0 - medium.g) * albedo / (1.0 - medium.g * albedo), azimuths=1)
    # Depths in transport mean free paths.
    places = depths[:, None] * (1.0 - medium.g * albedo)
    return np.stack([np.interp(place, found.cells.depths, column)
                     for place, column in zip(places.T, found.complete[0].T, strict=True)], axis=1)


def _ranks(weights: np.ndarray) -> np.ndarray:
    """The share of the weights below each, and half of its own."""
    total = np.cumsum(weights)
    return (total - 0.5 * weights) / max(total[-1], DEEPEST)
