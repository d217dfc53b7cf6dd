# SPDX-License-Identifier: GPL-3.0-or-later
"""Lobes of anisotropic stacks: a Glossy BSDF (GGX) whose Roughness, Anisotropy, Rotation and tilt follow the view and
its azimuth from the layer's tangent.

The id "oriented:N" names the N-th such lobe of a table. Its shape is five numbers in two strips, see kinds.table.SHAPE
and TILT: roughness in (0, 1], the root of the geometric mean of both widths alpha; a cos 2t and a sin 2t, with the
anisotropy a in [0, 1) and the angle t from the layer's tangent to the lobe's, which is its narrow axis; k and l, for
the normal N + k I + l N x I. The doubled angle has no jump where the lobe's tangent has turned by half a turn, and a
round lobe needs no tangent, so all five numbers are continuous."""

from __future__ import annotations

import numpy as np

from .. import _core
from .lobe import Geometry, Lobe, NodeRecipe
from .microfacet_lobes import MOST_ANISOTROPY, widths

PREFIX = "oriented:"
NUMBERS = 5  # of a shape


def lobe(number: float) -> Lobe:
    """The recipe of the closure. Its values depend on the table, see `values`."""
    name = f"{PREFIX}{number:g}"

    def evaluate(mu_o, mu_i, dphi):
        raise ValueError(f"closure {name}: its values depend on the shape in the table, see oriented_lobes.values")

    node = NodeRecipe("ShaderNodeBsdfAnisotropic", enums={"distribution": "GGX"}, moves=True, turns=True)
    return Lobe(name, "reflection", evaluate, node, narrow=True)


def values(shape: np.ndarray, mu_o, mu_i, dphi, phi_o) -> np.ndarray:
    """f * |cos theta_i| in 1/sr; `shape` [..., 5] broadcasts with the cosines and azimuths. `phi_o`: azimuth of the
    viewer from the layer's tangent; the light travels along phi_o - dphi, both in radians."""
    roughness, along, across, tilt, aside = np.moveaxis(np.asarray(shape, float), -1, 0)
    g = Geometry(mu_o, mu_i, -np.asarray(dphi, float))
    view, light = _vector(g.sin_o, 0.0, g.mu_o), _vector(g.light_x, g.light_y, g.mu_i)
    normal = _unit(_vector(tilt * g.sin_o, aside * g.sin_o, 1.0 + tilt * g.mu_o))
    # The layer's tangent across the tilted normal, turned about this, as by the socket Rotation
    second = _unit(np.cross(normal, _vector(np.cos(phi_o), -np.sin(phi_o), 0.0)))
    first = np.cross(second, normal)
    turn = 0.5 * np.arctan2(across, along)[..., None]
    tangent = np.cos(turn) * first + np.sin(turn) * second
    bitangent = np.cos(turn) * second - np.sin(turn) * first
    axes = np.stack(np.broadcast_arrays(tangent, bitangent, normal), axis=-2)
    alpha_x, alpha_y = widths(roughness, np.minimum(np.hypot(along, across), MOST_ANISOTROPY))
    # Anisotropy 0 has no narrow axis, and `widths` may give either
    narrow, wide = np.minimum(alpha_x, alpha_y), np.maximum(alpha_x, alpha_y)
    o, i = (np.einsum("...ij,...j->...i", axes, one) for one in (view, light))
    seen, lit = o[..., 2], i[..., 2]
    o_z, i_z = np.maximum(seen, 1e-9), np.maximum(lit, 1e-9)
    x, y, z = o[..., 0] + i[..., 0], o[..., 1] + i[..., 1], o_z + i_z
    stretched = (x / narrow) ** 2 + (y / wide) ** 2 + z**2
    facets = ((x**2 + y**2 + z**2) / stretched) ** 2 / (np.pi * narrow * wide)

    def hidden(direction, height):
        slope2 = ((narrow * direction[..., 0]) ** 2 + (wide * direction[..., 1]) ** 2) / height**2
        return 0.5 * (np.sqrt(1.0 + slope2) - 1.0)

    masking = 1.0 + hidden(o, o_z) + hidden(i, i_z)
    return np.where((seen > 0.0) & (lit > 0.0), facets / (4.0 * o_z * masking), 0.0)


def albedos(shape: np.ndarray, mu_o: np.ndarray, phi_o: np.ndarray) -> np.ndarray:
    """Directional albedos above the surface; `shape` [..., 5], `mu_o` and `phi_o` broadcast."""
    shape = np.asarray(shape, float)
    points = [np.ascontiguousarray(np.broadcast_to(np.asarray(one, float), shape.shape[:-1]).ravel())
              for one in (mu_o, phi_o)]
    found = _core.oriented_albedos(np.ascontiguousarray(shape.reshape(-1, NUMBERS)), *points)
    return found.reshape(shape.shape[:-1])


def sampled(shape: np.ndarray, mu_o: np.ndarray, phi_o: float, mu: np.ndarray, dphi: np.ndarray) -> np.ndarray:
    """`values` of shapes [view, 5] at views `mu_o` [view] of one azimuth, on the product grid of the light's cosines
    and azimuths: [view, light], cosines major."""
    return _core.oriented_values(np.ascontiguousarray(shape, float), np.ascontiguousarray(mu_o, float),
                                 np.full(len(mu_o), float(phi_o)), _core.LightDirections(mu, -dphi))


def _vector(x, y, z) -> np.ndarray:
    return np.stack(np.broadcast_arrays(x, y, z), axis=-1)


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.linalg.norm(vector, axis=-1, keepdims=True)
