# SPDX-License-Identifier: GPL-3.0-or-later
"""Piecewise cubic functions of depth, and integrals of such functions with exponential attenuation."""

from __future__ import annotations

import numpy as np

# Positions of a cell's four nodes (Gauss-Lobatto), and the coefficients [power, node] of the Lagrange cubics.
PLACES = np.array([0.0, 0.5 - 5.0**0.5 / 10.0, 0.5 + 5.0**0.5 / 10.0, 1.0])
CUBICS = np.linalg.inv(np.vander(PLACES, 4, increasing=True))
NODE_WEIGHTS = np.array([1.0, 5.0, 5.0, 1.0]) / 12.0
# Smaller attenuation factors are set to 0: otherwise products become denormal numbers, which are slow.
LEAST = 1e-18


def gauss(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights of Gauss-Legendre quadrature over [0, 1]."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * (nodes + 1.0), 0.5 * weights


FINE_NODES, FINE_WEIGHTS = gauss(10)


def growing_edges(first: float, growth: float, widest: float, share: float, end: float) -> np.ndarray:
    """Edges of cells from 0 to `end` or beyond. Widths grow from `first` by the factor `growth`, up to
    max(widest, share * depth)."""
    edges = [0.0]
    width = first
    while edges[-1] < end:
        edges.append(edges[-1] + width)
        width = min(width * growth, max(widest, share * edges[-1]))
    return np.array(edges)


class DepthCells:
    """Nodes at optical depths: four per cell, of which neighbouring cells share the one at their common edge.

    `depths` and `weights` (quadrature weights over depth) have the shape (nodes,)."""

    def __init__(self, edges: np.ndarray):
        self.edges = edges
        self.widths = np.diff(edges)
        inner = edges[:-1, None] + self.widths[:, None] * PLACES[1:]
        self.depths = np.concatenate([[0.0], inner.ravel()])
        self.weights = np.zeros(len(self.depths))
        for cell, width in enumerate(self.widths):
            self.weights[3 * cell:3 * cell + 4] += width * NODE_WEIGHTS

    def from_above(self, extinctions: np.ndarray) -> np.ndarray:
        """Matrices, shape (directions, nodes, nodes), that map node values of f to the node values of
        int_0^depth exp(-k (depth - t)) f(t) dt, for each complex extinction k per depth."""
        size = len(self.depths)
        matrices = np.zeros((size, len(extinctions), size), complex)
        reached = np.zeros((len(extinctions), size), complex)
        for cell, width in enumerate(self.widths):
            for place in range(1, 4):
                way = width * PLACES[place]
                powers = _attenuated_powers(extinctions * way) * (PLACES[place] ** np.arange(1, 5))[:, None] * width
                row = np.exp(-extinctions * way)[:, None] * reached
                row[:, 3 * cell:3 * cell + 4] += np.einsum("kj,kd->dj", CUBICS, powers)
                row[np.abs(row) < LEAST] = 0.0
                matrices[3 * cell + place] = row
            reached = matrices[3 * cell + 3]
        return np.ascontiguousarray(matrices.transpose(1, 0, 2))

    def from_below(self, extinctions: np.ndarray) -> np.ndarray:
        """Like from_above, for the integral int exp(-k (t - depth)) f(t) dt from the depth to the lowest node."""
        turned = DepthCells((self.edges[-1] - self.edges)[::-1])
        return np.ascontiguousarray(turned.from_above(extinctions)[:, ::-1, ::-1])

    def interpolation(self, depths: np.ndarray) -> np.ndarray:
        """Matrix, shape (depths, nodes), that interpolates node values at `depths`."""
        cells = np.clip(np.searchsorted(self.edges, depths, side="right") - 1, 0, len(self.widths) - 1)
        places = (depths - self.edges[cells]) / self.widths[cells]
        values = (places[:, None] ** np.arange(4)) @ CUBICS
        matrix = np.zeros((len(depths), len(self.depths)))
        for node in range(4):
            matrix[np.arange(len(depths)), 3 * cells + node] = values[:, node]
        return matrix


def _attenuated_powers(a: np.ndarray) -> np.ndarray:
    """int_0^1 exp(-a (1 - x)) x^k dx for k = 0 to 3, shape (4, ...). Computed by recurrence; for small |a| by
    quadrature, because the recurrence suffers from cancellation."""
    small = np.abs(a) < 1.5
    safe = np.where(small, 2.0, a)
    powers = np.empty((4, *a.shape), complex)
    powers[0] = (1.0 - np.exp(-safe)) / safe
    for k in (1, 2, 3):
        powers[k] = (1.0 - k * powers[k - 1]) / safe
    attenuated = np.exp(-a[small][..., None] * (1.0 - FINE_NODES)) * FINE_WEIGHTS
    for k in range(4):
        powers[k][small] = attenuated @ FINE_NODES**k
    return powers
