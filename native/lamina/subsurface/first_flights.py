# SPDX-License-Identifier: GPL-3.0-or-later
"""The first flights of light in a half-space, as in Cycles' random walk, with the Henyey-Greenstein phase function.

Light enters at a cosine and a uniform azimuth. A flight ends in a collision or outside. Light is weighted by
exp(i q x) with the lateral coordinate x; the mean over azimuths is J0(q r) (see docs/theory.md, lateral frequencies).
The extinction per depth of a direction at the azimuth phi is then (1 - i q sin(theta) cos(phi)) / cos(theta). Lengths
are in mean free paths."""

from __future__ import annotations

import numpy as np

from .depth_cells import LEAST, DepthCells, gauss, growing_edges

# Cycles draws the directions after the first nine collisions from the phase function.
FORWARD_COLLISIONS = 9


class Directions:
    """Directions of one hemisphere: Gauss-Legendre cosines times azimuths in (0, pi). Functions are even in azimuth."""

    def __init__(self, cosines: int, azimuths: int):
        self.cosines, self.cosine_weights = gauss(cosines)
        self.azimuths = (np.arange(azimuths) + 0.5) * np.pi / azimuths
        orders = np.arange(azimuths)
        self.waves = np.cos(np.outer(orders, self.azimuths))  # (order, azimuth)
        self.to_orders = self.waves / azimuths * np.where(orders == 0, 1.0, 2.0)[:, None]
        self.weights = np.repeat(self.cosine_weights, azimuths) / azimuths  # of all directions of a hemisphere

    def extinctions(self, q: float) -> np.ndarray:
        """Complex extinction per depth, shape (cosines * azimuths,)."""
        return extinctions(q, self.cosines, self.azimuths).ravel()


def extinctions(q: float, cosines: np.ndarray, azimuths: np.ndarray) -> np.ndarray:
    """Complex extinction per depth at the lateral frequency `q`, shape (cosines, azimuths)."""
    across = np.sqrt(1.0 - cosines**2)[:, None] * np.cos(azimuths)
    return (1.0 - 1j * q * across) / cosines[:, None]


class FirstFlights:
    """Light in its first flights for albedo 1 and beams that enter at the cosines `mu_in`. `count`: collisions after
    which light is followed until it leaves. `edges`: edges of cells of depth, by default for cosines from .02 on."""

    def __init__(self, g: float, mu_in: np.ndarray, cosines: int = 20, azimuths: int = 16,
                 count: int = FORWARD_COLLISIONS, edges: np.ndarray | None = None):
        self.mu_in, self.count = mu_in, count
        self.cells = DepthCells(growing_edges(0.01, 1.8, 2.0, 0.0, 40.0) if edges is None else edges)
        self.directions = Directions(cosines, azimuths)
        both = np.concatenate([self.directions.cosines, -self.directions.cosines])  # cosines > 0 point downwards
        most = 2 * cosines - 1  # the highest Legendre moment that the quadrature keeps normalised
        self._weights = np.tile(self.directions.cosine_weights, 2)
        # The mean of cos(m phi)^2 over azimuths is 1/2, and 1 for order 0.
        means = np.where(np.arange(azimuths) == 0, 1.0, 0.5)[:, None, None]
        self._scattering = _henyey_greenstein(g, both, both, azimuths, most) * means * self._weights
        self._first = _henyey_greenstein(g, both, mu_in, azimuths, most) * means

    def at(self, q: float) -> tuple[np.ndarray, np.ndarray]:
        """(leaving, collisions) at the lateral frequency `q`: the light that leaves after 1 to `count` collisions,
        shape (count, mu_in), and the density over depth of the next collision, shape (nodes, mu_in)."""
        d, cells = self.directions, self.cells
        half, turns, size, beams = len(d.cosines), len(d.azimuths), len(cells.depths), len(self.mu_in)
        sweeps = (cells.from_above(d.extinctions(q)), cells.from_below(d.extinctions(q)))
        falls = np.exp(-extinctions(q, self.mu_in, d.azimuths) * cells.depths[:, None, None])
        arriving = np.einsum("mp,nbp->mnb", d.to_orders, falls / self.mu_in[:, None])
        emitted = self._first[:, :, None, :] * arriving[:, None]  # (order, direction, node, beam)
        inverse = np.tile(1.0 / d.cosines, 2)[:, None, None, None]
        leaving = []
        collisions = np.empty(0)
        for collision in range(1, self.count + 1):
            sent = np.tensordot(d.waves, emitted, (0, 0)).transpose(1, 0, 2, 3)  # (direction, azimuth, node, beam)
            reached = np.concatenate([
                np.matmul(sweep, part.reshape(half * turns, size, beams)).reshape(half, turns, size, beams)
                for sweep, part in zip(sweeps, (sent[:half], sent[half:]), strict=True)])
            leaving.append(np.tensordot(d.weights, reached[half:, :, 0].reshape(-1, beams), (0, 0)).real)
            reached *= inverse
            reached[np.abs(reached) < LEAST] = 0.0
            orders = np.tensordot(d.to_orders, reached, (1, 1))
            if collision == self.count:
                collisions = np.tensordot(self._weights, orders[0], (0, 0)).real
            else:
                emitted = np.matmul(self._scattering, orders.reshape(turns, 2 * half, size * beams))
                emitted = emitted.reshape(orders.shape)
        return np.array(leaving), collisions


def _henyey_greenstein(g: float, to: np.ndarray, source: np.ndarray, orders: int, most: int) -> np.ndarray:
    """Azimuth orders of the phase function, shape (orders, to, source), from Legendre moments up to `most`. Normalised:
    the sum over orders m of order * cos(m dphi), integrated over cosines and averaged over azimuths, is 1."""
    moments = (np.arange(most + 1) + 0.5) * float(g) ** np.arange(most + 1)
    values = np.empty((orders, len(to), len(source)))
    for order in range(orders):
        left, right = (_associated_legendre(order, most, cosines) for cosines in (to, source))
        values[order] = (1.0 if order == 0 else 2.0) * (left.T * moments) @ right
    return values


def _associated_legendre(order: int, most: int, x: np.ndarray) -> np.ndarray:
    """sqrt((l - m)! / (l + m)!) P_l^m(x), shape (most + 1, x), by recurrence in the degree l."""
    values = np.zeros((most + 1, len(x)))
    if order > most:
        return values
    values[order] = np.prod([np.sqrt((2.0 * k - 1.0) / (2.0 * k) * (1.0 - x * x)) for k in range(1, order + 1)],
                            axis=0) if order else 1.0
    if order < most:
        values[order + 1] = np.sqrt(2.0 * order + 1.0) * x * values[order]
    for degree in range(order + 2, most + 1):
        earlier = np.sqrt((degree - 1.0) ** 2 - order**2) * values[degree - 2]
        later = (2.0 * degree - 1.0) * x * values[degree - 1]
        values[degree] = (later - earlier) / np.sqrt(float(degree**2 - order**2))
    return values
