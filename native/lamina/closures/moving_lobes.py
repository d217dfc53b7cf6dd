# SPDX-License-Identifier: GPL-3.0-or-later
"""Lobes that move with the view: a Glossy BSDF (GGX) whose Roughness, Anisotropy and tilt are read from the table.

The id "moving:N" names the N-th such lobe of a table. Its shape, (roughness, anisotropy, tilt), stands in a strip of
its own, see kinds.table.SHAPE: roughness in (0, 1], the root of the geometric mean of both widths alpha; anisotropy
in (-1, 1), positive if the lobe is narrow in the plane of incidence; tilt k, for the normal N + k I. Cycles 4.5
evaluates tilted microfacets rightly, but samples them wrongly; Cycles 5.0 does both rightly."""

from __future__ import annotations

import copy

import numpy as np

from .. import _core
from .lobe import ASIDE, Geometry, Lobe, NodeRecipe
from .microfacet_lobes import ggx_reflection, widths

PREFIX = "moving:"


def lobe(number: float) -> Lobe:
    """The recipe of the closure. Its values depend on the table, see `values`."""
    name = f"{PREFIX}{number:g}"

    def evaluate(mu_o, mu_i, dphi):
        raise ValueError(f"closure {name}: its values depend on the shape in the table, see moving_lobes.values")

    node = NodeRecipe("ShaderNodeBsdfAnisotropic", inputs={"Rotation": 0.0}, enums={"distribution": "GGX"},
                      vectors={"Tangent": ASIDE}, moves=True)
    return Lobe(name, "reflection", evaluate, node, narrow=True)


def values(shape: np.ndarray, mu_o, mu_i, dphi) -> np.ndarray:
    """f * |cos theta_i| in 1/sr; `shape` [..., 3] broadcasts with the cosines and azimuths."""
    roughness, anisotropy, tilt = np.moveaxis(np.asarray(shape, float), -1, 0)
    g = Geometry(mu_o, mu_i, dphi)
    normal_x, normal_z = tilt * g.sin_o, 1.0 + tilt * g.mu_o
    length = np.hypot(normal_x, normal_z)
    sine, cosine = normal_x / length, normal_z / length
    height = g.light_x * sine + g.mu_i * cosine
    turned = copy.copy(g)  # in the frame of the tilted normal
    turned.sin_o, turned.mu_o = g.sin_o * cosine - g.mu_o * sine, g.sin_o * sine + g.mu_o * cosine
    turned.light_x, turned.mu_i = g.light_x * cosine - g.mu_i * sine, np.maximum(height, 1e-9)
    seen = turned.mu_o > 0.0
    turned.mu_o = np.maximum(turned.mu_o, 1e-9)
    return np.where((height > 0.0) & seen, ggx_reflection(turned, *widths(roughness, anisotropy)), 0.0)


def albedos(shape: np.ndarray, mu_o: np.ndarray) -> np.ndarray:
    """Directional albedos above the surface; `shape` [..., 3] and `mu_o` broadcast."""
    shape = np.asarray(shape, float)
    mu_o = np.broadcast_to(np.asarray(mu_o, float), shape.shape[:-1])
    found = _core.moving_albedos(np.ascontiguousarray(shape.reshape(-1, 3)), np.ascontiguousarray(mu_o.ravel()))
    return found.reshape(mu_o.shape)


def sampled(shape: np.ndarray, mu_o: np.ndarray, mu: np.ndarray, dphi: np.ndarray) -> np.ndarray:
    """`values` of shapes [view, 3] at views `mu_o` [view], on the product grid of the light's cosines and azimuths:
    [view, light], cosines major."""
    return _core.moving_values(np.ascontiguousarray(shape, float), np.ascontiguousarray(mu_o, float),
                               _core.LightDirections(mu, dphi))
