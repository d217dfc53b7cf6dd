# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that is scattered a few times in a deep medium, and then leaves.

The first order, light that is scattered once, has a closed form (single_scattering). The others are computed at
lateral frequencies (first_flights). A mixture of Gaussians, fitted to the values at these frequencies, turns them into
densities over distance: exp(-r^2 / 2 s^2) / (2 pi s^2) has the transform exp(-q^2 s^2 / 2)."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np

from ..common.arguments import check_whole
from ..common.by_content import ByContent
from ..material.stack import Stack
from . import single_scattering
from .depth_cells import growing_edges
from .first_flights import FirstFlights
from .single_scattering import SingleScattering

# Light forgets its direction after 1 / (1 - g) scatterings, by similarity. ISOTROPIC: number of orders for one such
# scattering; MORE: for each further one. MOST keeps the time and the noise of renders in bounds.
ISOTROPIC, MORE, MOST = 1, 3.25, 14
# Per mean free path. Orders from the second on fall below 1e-3 of their flux beyond the last frequency.
FREQUENCIES = np.concatenate([[0.0], np.geomspace(0.08, 30.0, 25)])
WIDTHS = np.geomspace(0.02, 25.0, 30)  # of the Gaussians, in mean free paths
LEAST_SINGULAR_VALUE = 1e-7  # of the fit, relative to the largest
CELLS = (0.01, 1.8, 2.0, 0.0, 25.0)  # of depth, for a beam along the normal
GRAZING_CELLS = (0.0005, 1.8, 2.0, 0.0, 25.0)  # for beams at all cosines
# Quadrature by the largest |g|: cosines of a hemisphere, and azimuths over half a turn. The highest Legendre moment of
# the phase function is then below .007. Beyond the last |g|, single scattering alone is in this accuracy.
QUADRATURE = ((0.84, 16, 12), (0.9, 24, 18))


@dataclass(frozen=True, eq=False)
class FirstOrders(ByContent):
    """The orders of scattering 1 to `count` of the medium `medium`."""

    medium: SingleScattering
    count: int

    def density(self, r: np.ndarray, index: int) -> np.ndarray:
        """Flux density in one channel at the distances `r`, mm, from a beam along the normal with unit flux, 1/mm^2."""
        sigma = self.medium.extinction[index]
        several = _powers(self.medium.sigma_s[index] / sigma, self.count) @ _mixtures(self.medium.g, self.count)
        square = (r[:, None] * sigma / WIDTHS) ** 2
        gaussians = np.exp(-0.5 * square) / (2.0 * math.pi * WIDTHS**2)
        return self.medium.density(r, index) + sigma**2 * (gaussians @ several)

    def reflectance(self, mu: np.ndarray) -> np.ndarray:
        """Reflected flux for a beam at the cosines `mu` > 0, shape (n,); result of shape (n, channels)."""
        once = self.medium.reflectance(mu)
        if self.count == 1:
            return once
        leaving = self._flights(mu).at(0.0)[0][1:]
        albedo = self.medium.sigma_s / self.medium.extinction
        return once + np.stack([_powers(a, self.count) @ leaving for a in albedo], axis=1)


    def next_collision(self, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The density over depth of collision `count` + 1 without absorption, for beams at the cosines `mu`: depths in
        mean free paths, their quadrature weights, and densities of shape (depths, mu)."""
        flights = self._flights(mu)
        return flights.cells.depths, flights.cells.weights, flights.at(0.0)[1]

    def _flights(self, mu: np.ndarray) -> FirstFlights:
        """Flights whose lateral distances do not count: one azimuth is enough. Stronger forward scattering than the
        quadrature allows, which only next_collision meets, is taken for the strongest that the quadrature allows."""
        g = min(max(self.medium.g, -QUADRATURE[-1][0]), QUADRATURE[-1][0])
        nodes, _ = _quadrature(g)
        return FirstFlights(g, mu, nodes, 1, self.count, growing_edges(*GRAZING_CELLS))


def of_stack(stack: Stack, count: int | None = None) -> FirstOrders | None:
    """The first `count` orders of scattering of the topmost medium, by default as many as count_for tells. None where
    single_scattering has no closed form. Raises ArgumentError."""
    if count is not None:
        check_whole(count, "scatterings", 1, MOST, f"must be a whole number from 1 to {MOST}, or None")
    medium = single_scattering.of_stack(stack)
    if medium is None:
        return None
    return FirstOrders(medium, 1 if _is_single(medium.g) else count or count_for(medium.g))


def count_for(g: float) -> int:
    """Number of orders for the mean cosine `g`; 1 beyond the |g| of QUADRATURE."""
    if _is_single(g):
        return 1
    forward = max(g, 0.0)
    return int(min(round(ISOTROPIC + MORE * forward / (1.0 - forward)), MOST))


def _is_single(g: float) -> bool:
    """True if the quadrature allows single scattering only."""
    return abs(g) > QUADRATURE[-1][0]


def _quadrature(g: float) -> tuple[int, int]:
    """Numbers of cosines and azimuths."""
    return next((nodes, turns) for largest, nodes, turns in QUADRATURE if abs(g) <= largest)


def _powers(albedo: float, count: int) -> np.ndarray:
    """Powers of the albedo that belong to the orders 2 to `count`."""
    return albedo ** np.arange(2, count + 1)


@functools.lru_cache(maxsize=8)
def _mixtures(g: float, count: int) -> np.ndarray:
    """Weights of the Gaussians for the orders 2 to `count` at albedo 1 and extinction 1, shape (count - 1, WIDTHS)."""
    if count == 1:
        return np.zeros((0, len(WIDTHS)))
    flights = FirstFlights(g, np.ones(1), *_quadrature(g), count, growing_edges(*CELLS))
    leaving = np.array([flights.at(q)[0][1:, 0] for q in FREQUENCIES])  # (frequency, order)
    transforms = np.exp(-0.5 * (FREQUENCIES[:, None] * WIDTHS) ** 2)
    return np.linalg.lstsq(transforms, leaving, rcond=LEAST_SINGULAR_VALUE)[0].T
