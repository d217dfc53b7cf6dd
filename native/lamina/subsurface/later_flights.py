# SPDX-License-Identifier: GPL-3.0-or-later
"""The flights of Cycles' random walk from the tenth collision on: isotropic scattering with transport coefficients.

By similarity the transport extinction is sigma_t (1 - albedo g), and the transport albedo is
(1 - g) albedo / (1 - albedo g). Lengths are in transport mean free paths."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .depth_cells import DepthCells, growing_edges
from .first_flights import Directions

MOST_FLIGHTS = 256  # Cycles discards light that is still inside after this number of flights
LATER_FLIGHTS = MOST_FLIGHTS - 10


class Escape(NamedTuple):
    """The light, weighted by J0(q r), that leaves a half-space after isotropic emission inside. Arrays of shape
    (frequencies, depth nodes, albedos): with and without Cycles' limit on the number of flights."""

    cells: DepthCells
    limited: np.ndarray
    complete: np.ndarray


def escape(frequencies: np.ndarray, albedos: np.ndarray, azimuths: int = 16) -> Escape:
    """Light that leaves after isotropic emission at each depth, by lateral frequency and transport albedo. At
    frequency 0 one of the `azimuths` is enough.

    Solves V = E + albedo K V. E is the light that leaves without a collision; K gives the density of collisions after
    isotropic emission. With the limit, the equation is iterated once per flight; without it, solved by elimination."""
    cells = DepthCells(growing_edges(0.01, 1.8, 0.5, 0.35, 5000.0))
    directions = Directions(24, azimuths)
    cosines = np.repeat(directions.cosines, len(directions.azimuths))
    identity = np.eye(len(cells.depths))
    limited, complete = [], []
    for q in frequencies:
        k = directions.extinctions(q)
        both = (cells.from_above(k) + cells.from_below(k)).real
        collisions = np.tensordot(0.5 * directions.weights / cosines, both, (0, 0))
        at_once = np.tensordot(0.5 * directions.weights, np.exp(-k[:, None] * cells.depths), (0, 0)).real[:, None]
        leaving = np.tile(at_once, (1, len(albedos)))
        for _ in range(LATER_FLIGHTS - 1):
            leaving = at_once + albedos * (collisions @ leaving)
        limited.append(leaving)
        complete.append(np.stack([np.linalg.solve(identity - a * collisions, at_once[:, 0]) for a in albedos], axis=1))
    return Escape(cells, np.array(limited), np.array(complete))
