# SPDX-License-Identifier: GPL-3.0-or-later
"""Opaque things around a solid."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import numpy as np

from ..common.arguments import finite_array
from ..common.errors import ArgumentError, DustError
from ..settling.mesh import Mesh, checked_mesh

MOST_ALBEDO = 0.98  # light between white things would bounce for very long


@dataclass(frozen=True, eq=False)
class Occluders:
    """Opaque things around a solid: they cast shadows on it, and reflect light diffusely, from both sides of a face.
    vertices: (n, 3) in mm; triangles: (m, 3) indices. They need not be closed. `albedo`: one number, (3,) or (m, 3),
    [0, 1], linear; above .98 counts as .98. `emission`: radiance that both sides emit, in the same shapes, 0 or more.
    Emitted light is light of the surroundings; walks find it by chance, so small bright faces make much noise. What
    lies inside the solid has no effect. Raises ArgumentError."""

    vertices: np.ndarray
    triangles: np.ndarray
    albedo: np.ndarray | float = 0.0
    emission: np.ndarray | float = 0.0

    def __post_init__(self):
        try:
            mesh = checked_mesh(Mesh(self.vertices, self.triangles), "occluders")
        except DustError as error:
            raise ArgumentError(str(error)) from None
        count = len(mesh.triangles)
        if not count:
            raise ArgumentError("occluders.triangles is empty: must have faces, or pass None")
        albedo = np.minimum(_rows(self.albedo, "albedo", count, 1.0), MOST_ALBEDO)
        emission = _rows(self.emission, "emission", count, np.inf)
        for name, value in (("vertices", mesh.vertices), ("triangles", mesh.triangles), ("albedo", albedo),
                            ("emission", emission)):
            object.__setattr__(self, name, value)

    @property
    def hash(self) -> str:
        digest = hashlib.sha256()
        for array in (self.vertices, self.triangles, self.albedo, self.emission):
            digest.update(np.ascontiguousarray(array).data)
        return digest.hexdigest()


def _rows(values, name: str, count: int, most: float) -> np.ndarray:
    """(count, 3) float32 of values in [0, most]."""
    array = finite_array(values, f"occluders.{name}")
    if array.shape not in ((), (3,), (count, 3)):
        raise ArgumentError(f"occluders.{name} has the shape {array.shape}: must be a number, (3,), or (m, 3)")
    if array.min() < 0.0 or array.max() > most:
        rule = f"0 to {most:g}" if np.isfinite(most) else "0 or more"
        raise ArgumentError(f"occluders.{name} reaches from {array.min():g} to {array.max():g}: must be {rule}")
    return np.ascontiguousarray(np.broadcast_to(array, (count, 3)), np.float32)
