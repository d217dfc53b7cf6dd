# SPDX-License-Identifier: GPL-3.0-or-later
"""Integrals over a plane of functions of the distance from a point."""

from __future__ import annotations

import math

import numpy as np

LEAST_FLUX = 1e-300  # avoids 0 / 0 in channels without light


def distances(scale: float, count: int) -> np.ndarray:
    """Nodes for integrals over the plane: `count` distances r, uniform in r / (r + scale)."""
    u = (np.arange(count) + 0.5) / count
    return scale * u / (1.0 - u)


def areas(r: np.ndarray) -> np.ndarray:
    """Areas of the rings around the nodes `r` of distances."""
    scale = r[0] * (2.0 * len(r) - 1.0)  # r[0] = scale u / (1 - u) with u = .5 / len(r)
    edges = np.arange(len(r) + 1) / len(r)
    edges = scale * edges[:-1] / (1.0 - edges[:-1])
    return math.pi * np.diff(np.append(edges, 2.0 * r[-1] - edges[-1]) ** 2)


def within(r: np.ndarray, density: np.ndarray) -> np.ndarray:
    """Flux within the outer edge of each ring, for a flux density of shape (len(r), channels)."""
    return np.cumsum(density * areas(r)[:, None], axis=0)
