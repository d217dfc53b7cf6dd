# SPDX-License-Identifier: GPL-3.0-or-later
"""The tabulated response of Cycles' random walk, interpolated to an anisotropy and to given entry directions."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..common.archive import load_archive
from .node_response import G_NODES, LEAST_MU, LEAST_U, MOST_U, MU_NODES, U_NODES, local_cubic, single_albedo

TABLE = Path(__file__).with_name("response.npz")
CURVE = np.linspace(LEAST_U, MOST_U, 4000)  # u of node_response


class Curves(NamedTuple):
    """Values along CURVE: single-scattering albedo; exit albedo and mean exit distance (in transport mean free paths)
    with Cycles' limit of flights; exit albedo and mean exit distance without the limit."""

    single: np.ndarray
    albedo: np.ndarray
    distance: np.ndarray
    full_albedo: np.ndarray
    full_distance: np.ndarray


def response_curves(g: float, cosines: np.ndarray, shares: np.ndarray) -> Curves:
    """The response at an anisotropy `g` in [0, .9] to light that enters in the given `shares` (sum at most 1) at
    `cosines` in (0, 1], measured inside."""
    at_g = np.tensordot(_polynomial(G_NODES, np.array([g]))[0], _logarithms(), (0, 0))
    at_mu = np.exp(np.tensordot(_polynomial(MU_NODES, np.maximum(cosines, LEAST_MU)), at_g, (1, 1)))
    fine = local_cubic(CURVE, (LEAST_U, MOST_U), at_mu.transpose(2, 0, 1))  # (u, mu, quantity)
    single = single_albedo(CURVE, g)
    light, full_light = fine[..., 0] @ shares, fine[..., 2] @ shares
    return Curves(single, single * light, (fine[..., 0] * fine[..., 1]) @ shares / light, single * full_light,
                  (fine[..., 2] * fine[..., 3]) @ shares / full_light)


def place_of(light: np.ndarray, albedo: np.ndarray) -> np.ndarray:
    """u at which the exit albedo `light`, which decreases along CURVE, is `albedo`."""
    return np.interp(-albedo, -light, CURVE)


def distance_per_path(distances: np.ndarray, curves: Curves, g: float, u: np.ndarray) -> np.ndarray:
    """Mean exit distance of media at `u`, in mean free paths. `distances`: a curve, in transport mean free paths."""
    return np.interp(u, CURVE, distances) / (1.0 - g * np.interp(u, CURVE, curves.single))


@functools.cache
def _logarithms() -> np.ndarray:
    """Logarithms of exit albedo per single-scattering albedo and of mean exit distance, shape (g, quantity, mu, u).

    The response of forward-scattering media varies by orders of magnitude along g and mu. Polynomials fit the
    logarithms better."""
    table = load_archive(TABLE, "response")[1][0].astype(float)
    table[:, (0, 2)] /= np.array([single_albedo(U_NODES, g) for g in G_NODES])[:, None, None]
    return np.log(table)


def _polynomial(nodes: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Matrix, shape (x, nodes), that interpolates node values at x by a polynomial."""
    weights = np.empty((len(x), len(nodes)))
    for k, node in enumerate(nodes):
        others = np.delete(nodes, k)
        weights[:, k] = np.prod((x[:, None] - others) / (node - others), axis=1)
    return weights
