# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured bases made from functions: facets over Lambert, written here by vectors, without Lamina's own facets."""

from __future__ import annotations

import numpy as np

from lamina import Measured
from lamina.material.half_table import knots, table_from, text_from


def facets(alpha, normal, diffuse):
    """f(wi, wo) in 1/sr of unit vectors (..., 3), the normal along z: GGX facets with Schlick's reflectance `normal` at
    normal incidence and Smith's correlated masking, beside a Lambert surface."""
    def value(wi, wo):
        half = wi + wo
        half = half / np.linalg.norm(half, axis=-1, keepdims=True)
        along = np.clip(np.sum(half * wi, axis=-1), 0.0, 1.0)
        mu_i, mu_o, z = wi[..., 2], wo[..., 2], half[..., 2]
        density = alpha**2 / (np.pi * (z * z * (alpha**2 - 1.0) + 1.0)**2)
        slope_i, slope_o = (np.sqrt(alpha**2 * (1.0 - mu * mu) / (mu * mu) + 1.0) for mu in (mu_i, mu_o))
        fresnel = normal + (1.0 - normal) * (1.0 - along)**5
        return density * fresnel * 2.0 / (slope_i + slope_o) / (4.0 * mu_i * mu_o) + diffuse / np.pi
    return value


def vectors(mu_o, mu_i, dphi):
    """(wi, wo) of directions as lamina.ScatteringFunction.brdf takes them."""
    mu_o, mu_i, dphi = np.broadcast_arrays(mu_o, mu_i, dphi)
    across_i, across_o = np.sqrt(1.0 - mu_i**2), np.sqrt(1.0 - mu_o**2)
    return (np.stack([-across_i, 0.0 * mu_i, mu_i], axis=-1),
            np.stack([across_o * np.cos(dphi), across_o * np.sin(dphi), mu_o], axis=-1))


def measured(*functions, name=""):
    """The base that measurements of these functions give, one per channel."""
    h, _, _, mu_o, mu_i = knots()
    # The azimuth between both directions from their angle
    d = knots()[1]
    between = (np.cos(2.0 * d) - mu_o * mu_i) / np.maximum(np.sqrt((1.0 - mu_o**2) * (1.0 - mu_i**2)), 1e-12)
    dphi = np.pi - np.arccos(np.clip(between, -1.0, 1.0))
    values = np.stack([one(*vectors(mu_o, mu_i, dphi)) for one in functions], axis=-1)
    return Measured(text_from(table_from(values)), name)
