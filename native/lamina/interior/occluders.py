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
    [0, 1], linear; above .98 counts as .98. What lies inside the solid has no effect. Raises ArgumentError."""

    vertices: np.ndarray
    triangles: np.ndarray
    albedo: np.ndarray | float = 0.0

    def __post_init__(self):
        try:
            mesh = checked_mesh(Mesh(self.vertices, self.triangles), "occluders")
        except DustError as error:
            raise ArgumentError(str(error)) from None
        if not len(mesh.triangles):
            raise ArgumentError("occluders.triangles is empty: must have faces, or pass None")
        albedo = finite_array(self.albedo, "occluders.albedo")
        if albedo.shape not in ((), (3,), (len(mesh.triangles), 3)):
            raise ArgumentError(f"occluders.albedo has the shape {albedo.shape}: must be a number, (3,), or (m, 3)")
        if albedo.min() < 0.0 or albedo.max() > 1.0:
            raise ArgumentError(f"occluders.albedo reaches from {albedo.min():g} to {albedo.max():g}: must be 0 to 1")
        rows = np.broadcast_to(np.minimum(albedo, MOST_ALBEDO), (len(mesh.triangles), 3))
        for name, value in (("vertices", mesh.vertices), ("triangles", mesh.triangles),
                            ("albedo", np.ascontiguousarray(rows, np.float32))):
            object.__setattr__(self, name, value)

    @property
    def hash(self) -> str:
        digest = hashlib.sha256()
        for array in (self.vertices, self.triangles, self.albedo):
            digest.update(np.ascontiguousarray(array).data)
        return digest.hexdigest()
