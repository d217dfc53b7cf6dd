# SPDX-License-Identifier: GPL-3.0-or-later
"""What a table for renderers needs to draw directions: densities on half vectors, and chances of its parts."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..exchange.half_vectors import dilated, half_vector_grid
from ..solver.solve import ScatteringFunction
from .render_knots import SIDES, fluxes

if TYPE_CHECKING:
    from .render_table import RenderTable

VIEWS, HALF_VECTORS = 32, 64  # angles of views, and nodes in each of both axes
EVEN = 0.02  # share of the density that is even over the light's cosine, where the table may be wrong


def sampling_of(table: RenderTable, functions: list[ScatteringFunction]) -> tuple[np.ndarray, np.ndarray]:
    """`density` and `chance` of a table, from its own values and from the fluxes of its rows."""
    taus = [None] if table.rows == 1 else table.row_taus
    smooth, facets = (one.mean(axis=-1, keepdims=True) if one.size else one for one in (table.smooth, table.facets))
    grey = replace(table, smooth=smooth, facets=facets)
    density = [[_density(grey, number, tau) for tau in taus] for number in range(len(table.sights))]
    mu = np.cos(table.theta_views)
    chance = np.array([[np.stack([part.mean(axis=-1) for part in fluxes(one, *sight, mu)], axis=-1)
                        for one in functions] for sight in table.sights])
    for side in SIDES:
        own = [number for number, sight in enumerate(table.sights) if sight[0] == side]
        if own:
            chance[own] /= np.maximum(chance[own].sum(axis=(0, 3)), 1e-12)[None, :, :, None]
    return np.array(density, np.float32), chance


def _density(table: RenderTable, sight: int, tau: float | None) -> np.ndarray:
    """The light of half vectors towards each view."""
    grid = half_vector_grid(HALF_VECTORS)
    found = np.empty((VIEWS, HALF_VECTORS, HALF_VECTORS))
    valid = np.empty(found.shape, bool)
    for k, angle in enumerate(table.theta_views):
        view = np.array([math.sin(angle), 0.0, math.cos(angle)])
        # The other half of the azimuths is its mirror image.
        cosine, light, size = (part[:HALF_VECTORS // 2] for part in grid.lights(view))
        above = light[..., 2] > 0.0
        seen = np.where(above[..., None], light, light * [1.0, 1.0, -1.0]).reshape(-1, 3)
        even = np.abs(light[..., 2]) * size
        half = table.values(sight, view[None], seen, tau).reshape(above.shape) * even
        half += EVEN * max(half.sum(), 1e-12) * even / even.sum()
        found[k] = np.concatenate([half, half[::-1]])
        lit = above & (cosine > 0.0)
        valid[k] = np.concatenate([lit, lit[::-1]])
    return found * dilated(valid)  # nodes outside all cells with a valid direction need no samples
