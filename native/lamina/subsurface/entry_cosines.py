# SPDX-License-Identifier: GPL-3.0-or-later
"""Entry directions of Cycles' random walk: the view direction, refracted by the facets of a GGX distribution."""

from __future__ import annotations

import numpy as np

from ..common.fresnel import fresnel
from .node_parameters import LEAST_IOR

SIDE = 24  # facets are sampled with the centres of SIDE x SIDE strata as random numbers
VIEWS = 8  # Gauss-Legendre nodes in the view's cosine, for the mean over views
BINS = 64  # of the entry cosines of that mean


def mean_entry_cosines(ior: float, roughness: float) -> tuple[np.ndarray, np.ndarray]:
    """(cosines, shares) of the directions inside, for light from all directions with the flux of a uniform sky.

    Above LEAST_IOR there is a boundary, and views count by the light that a smooth boundary lets in. At LEAST_IOR there
    is no boundary above the node, but the node still refracts."""
    nodes, weights = np.polynomial.legendre.leggauss(VIEWS)
    views = 0.5 * (nodes + 1.0)
    passed = views * weights * ((1.0 - fresnel(views, ior)) if ior > LEAST_IOR else 1.0)
    found = [entry_cosines(float(mu), ior, roughness) for mu in views]
    cosines = np.concatenate([one for one, _ in found])
    shares = np.concatenate([part * share for (_, part), share in zip(found, passed / passed.sum(), strict=True)])
    if len(cosines) <= BINS:
        return cosines, shares
    place = np.minimum((cosines * BINS).astype(int), BINS - 1)
    total = np.bincount(place, shares, BINS)
    used = total > 0.0
    return np.bincount(place, shares * cosines, BINS)[used] / total[used], total[used]


def entry_cosines(mu: float, ior: float, roughness: float) -> tuple[np.ndarray, np.ndarray]:
    """(cosines, shares) of the directions inside, for a view at the cosine `mu` through a boundary of index `ior`.

    As in Cycles, `roughness` is the width alpha of the facets, facets are drawn from the distribution of visible
    normals (Heitz 2018), all light is refracted, and light refracted upwards is lost."""
    if roughness == 0.0:
        return np.array([np.sqrt(1.0 - (1.0 - mu * mu) / (ior * ior))]), np.ones(1)
    middles = (np.arange(SIDE) + 0.5) / SIDE
    u, v = (axis.ravel() for axis in np.meshgrid(middles, middles))
    across = np.sqrt(1.0 - mu * mu)
    stretched = np.array([roughness * across, 0.0, mu]) / np.hypot(roughness * across, mu)
    radius, turn = np.sqrt(u), 2.0 * np.pi * v
    x = radius * np.cos(turn)
    share = 0.5 * (1.0 + stretched[2])
    y = (1.0 - share) * np.sqrt(1.0 - x * x) + share * radius * np.sin(turn)
    z = np.sqrt(np.maximum(0.0, 1.0 - x * x - y * y))
    # Frame of the stretched view direction, which lies in the plane y = 0.
    facets = np.stack([y * -stretched[2] + z * stretched[0], x, y * stretched[0] + z * stretched[2]])
    facets *= np.array([roughness, roughness, 1.0])[:, None]
    facets[2] = np.maximum(facets[2], 0.0)
    facets /= np.linalg.norm(facets, axis=0)
    meeting = across * facets[0] + mu * facets[2]
    inside = np.sqrt(1.0 - (1.0 - meeting**2) / ior**2)
    cosines = mu / ior - (meeting / ior - inside) * facets[2]
    enters = cosines > 0.0
    return cosines[enters], np.full(int(enters.sum()), 1.0 / SIDE**2)
