# SPDX-License-Identifier: GPL-3.0-or-later
"""Half vectors between a view and its light, on the grid of .bsdf files (Dupuy and Jakob 2018)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

# The most grazing angle of the tables; at the horizon itself the cosine is 0.
GRAZING = math.radians(89.9)


def incident_angles(count: int) -> np.ndarray:
    """theta_i of a file's slices in radians, from the normal to GRAZING. They are denser near GRAZING, where values
    change fastest."""
    s = np.linspace(0.0, 1.0, count)
    return GRAZING * s * (2.0 - s)


@dataclass(frozen=True, eq=False)
class HalfVectorGrid:
    """`normals` [v, u, 3]: half vectors; `size` [v, u]: solid angle of half vectors per unit square of u and v."""

    normals: np.ndarray
    size: np.ndarray

    def lights(self, view: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """For a view in the plane of azimuth 0: (its cosine with the half vectors, unit directions of light, solid
        angle of light per unit square of u and v)."""
        cosine = self.normals @ view
        return cosine, 2.0 * cosine[..., None] * self.normals - view, self.size * 4.0 * np.abs(cosine)


def half_vector_grid(size: int) -> HalfVectorGrid:
    """theta = u^2 pi / 2, and the azimuth from that of the view is (2 v - 1) pi, both u and v uniform from 0 to 1."""
    u, v = np.meshgrid(np.linspace(0.0, 1.0, size), np.linspace(0.0, 1.0, size))
    theta, phi = 0.5 * math.pi * u * u, (2.0 * v - 1.0) * math.pi
    normals = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    return HalfVectorGrid(normals, 2.0 * math.pi**2 * u * np.sin(theta))


def dilated(mask: np.ndarray) -> np.ndarray:
    """The mask [theta_i, v, u] and all neighbours of its true entries. The azimuth v is periodic; its two ends are the
    same azimuth."""
    grown = mask
    for axis, closed in ((0, False), (1, True), (2, False)):
        padded = np.moveaxis(grown, axis, 0)
        first, last = (padded[-2:-1], padded[1:2]) if closed else (padded[:1], padded[-1:])
        padded = np.concatenate([first, padded, last])
        grown = np.moveaxis(padded[:-2] | padded[1:-1] | padded[2:], 0, axis)
    return grown
