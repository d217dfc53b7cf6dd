# SPDX-License-Identifier: GPL-3.0-or-later
"""The response of Cycles' random walk in a half-space: exit albedo and mean exit distance, computed deterministically.

tools/make_subsurface_table.py tabulates this; the package reads the table (see response_table)."""

from __future__ import annotations

import numpy as np

from .first_flights import FORWARD_COLLISIONS, FirstFlights
from .later_flights import Escape, escape

# Axes of the table: g and entry cosine at Chebyshev-Lobatto points, and u with u^4 = 1 - transport albedo.
LARGEST_G = 0.9
G_COUNT, MU_COUNT, U_COUNT = 15, 12, 40
LEAST_MU, LEAST_U, MOST_U = 0.02, 0.03, 0.995

# Lateral frequencies: per mean free path for the first flights, per transport mean free path for the later ones.
FIRST_FREQUENCIES = np.geomspace(2e-3, 12.0, 30)
LATER_FREQUENCIES = np.geomspace(2e-4, 15.0, 42)


def chebyshev(low: float, high: float, count: int) -> np.ndarray:
    """Chebyshev-Lobatto points, ascending, including both ends."""
    return 0.5 * (low + high) - 0.5 * (high - low) * np.cos(np.pi * np.arange(count) / (count - 1))


G_NODES = chebyshev(0.0, LARGEST_G, G_COUNT)
MU_NODES = chebyshev(LEAST_MU, 1.0, MU_COUNT)
U_NODES = np.linspace(LEAST_U, MOST_U, U_COUNT)


def single_albedo(u: np.ndarray, g: float) -> np.ndarray:
    """Single-scattering albedo of the medium with 1 - transport albedo = u^4 (van de Hulst's similarity)."""
    return (1.0 - u**4) / (1.0 - g * u**4)


def later_escape() -> Escape:
    """The later flights at frequency 0 and LATER_FREQUENCIES, which are the same for all g."""
    return escape(np.concatenate([[0.0], LATER_FREQUENCIES]), 1.0 - U_NODES**4)


def response(g: float, later: Escape) -> np.ndarray:
    """Exit albedo and mean exit distance, in transport mean free paths, with Cycles' limit of flights and without:
    shape (4, MU_COUNT, U_COUNT), the limited pair first."""
    first = FirstFlights(g, MU_NODES)
    found = [first.at(q) for q in np.concatenate([[0.0], FIRST_FREQUENCIES])]
    leaving, collisions = (np.array(part) for part in zip(*found, strict=True))
    all_light = leaving[0].sum(axis=0) + first.cells.weights @ collisions[0]
    leaving, collisions = leaving / all_light, collisions / all_light  # 1 within 1e-4
    table = np.empty((4, MU_COUNT, U_COUNT))
    for k, u in enumerate(U_NODES):
        albedo = single_albedo(u, g)
        transport = 1.0 - albedo * g  # transport extinction per extinction
        q = LATER_FREQUENCIES * transport
        shared = int(np.sum(q <= FIRST_FREQUENCIES[-1]))
        q = np.concatenate([q[:shared], np.geomspace(q[shared - 1], FIRST_FREQUENCIES[-1], 12)[1:]])
        early_at = np.tensordot(albedo ** np.arange(1, FORWARD_COLLISIONS + 1), leaving, (0, 1))
        early, tenth = _at_frequencies(early_at, q), _at_frequencies(collisions, q)
        from_depth = later.cells.interpolation(first.cells.depths * transport) * first.cells.weights[:, None]
        for pair, escaped in enumerate((later.limited, later.complete)):
            light = early_at[0] + albedo**10 * (from_depth @ escaped[0, :, k]) @ collisions[0]
            waves = early.copy()
            # Beyond LATER_FREQUENCIES the transform of the later flights is negligible.
            late = from_depth @ escaped[1:shared + 1, :, k].T  # (node, frequency)
            waves[:shared] += albedo**10 * np.einsum("qtm,tq->qm", tenth[:shared], late)
            table[2 * pair, :, k] = light
            table[2 * pair + 1, :, k] = transport * _mean_distance(q, light, waves)
    return table


def _at_frequencies(values: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Interpolate values at frequency 0 and FIRST_FREQUENCIES (axis 0) to `q`: by cubics in log(q), and below the first
    frequency linearly in q^2."""
    between = local_cubic(np.log(q), np.log(FIRST_FREQUENCIES[[0, -1]]), values[1:])
    low = q < FIRST_FREQUENCIES[0]
    share = (q[low] / FIRST_FREQUENCIES[0]).reshape(-1, *(1,) * (values.ndim - 1)) ** 2
    between[low] = values[0] + share * (values[1] - values[0])
    return between


def local_cubic(x: np.ndarray, ends, values: np.ndarray) -> np.ndarray:
    """Interpolate values on a uniform grid from ends[0] to ends[1] (axis 0) to `x`, by cubics through four nodes."""
    last = len(values) - 1
    place = (np.asarray(x) - ends[0]) / (ends[1] - ends[0]) * last
    start = np.clip(np.floor(place).astype(int) - 1, 0, last - 3)
    t = (place - start).reshape(*place.shape, *(1,) * (values.ndim - 1))
    total = np.zeros_like(t)
    for k in range(4):
        others = [j for j in range(4) if j != k]
        total = total + np.prod([(t - j) / (k - j) for j in others], axis=0) * values[start + k]
    return total


def _mean_distance(q: np.ndarray, light: np.ndarray, waves: np.ndarray) -> np.ndarray:
    """Mean of r from the transform R of the leaving light: int_0^inf (R(0) - R(q)) / q^2 dq / R(0). Assumes that the
    difference is proportional to q^2 below the first q, and that R is proportional to 1/q beyond the last q."""
    rest = (light - waves) / q[:, None]
    inner = np.sum(0.5 * (rest[1:] + rest[:-1]) * np.diff(np.log(q))[:, None], axis=0)
    return (inner + rest[0] + light / q[-1] - 0.5 * waves[-1] / q[-1]) / light
