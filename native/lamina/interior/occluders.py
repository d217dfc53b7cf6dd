# SPDX-License-Identifier: GPL-3.0-or-later
"""Opaque things around a solid."""

from __future__ import annotations

import hashlib
import numbers
from dataclasses import dataclass

import numpy as np

from ..common.arguments import check_whole, finite_array
from ..common.errors import ArgumentError, DustError, quoted
from ..settling.mesh import Mesh, checked_mesh
from .lamps import MOST_LINKINGS

MOST_ALBEDO = 0.98  # light between white things would bounce for very long
ALL_LINKINGS = (1 << MOST_LINKINGS) - 1


@dataclass(frozen=True, eq=False)
class Occluders:
    """Opaque things around a solid: they cast shadows on it, and reflect light diffusely, from both sides of a face.
    vertices: (n, 3) in mm; triangles: (m, 3) indices. They need not be closed. `albedo`: one number, (3,) or (m, 3),
    [0, 1], linear; above .98 counts as .98. `emission`: radiance that both sides emit, in the same shapes, 0 or more.
    Emitted light is light of the surroundings; walks find it by chance, so small bright faces make much noise. What
    lies inside the solid has no effect.

    Linkings choose which light meets what; lamps and emission have the number of a linking, 0 to 63. `shadows`,
    `lit`: the linkings whose light a face takes, and those whose light it reflects, as the bits of whole numbers, one
    or (m,). `linking`: of the emission, one number or (m,). `solid_lit`: the linkings whose emission lights the solid,
    as bits; the solid takes all light. By default all light meets everything. Raises ArgumentError."""

    vertices: np.ndarray
    triangles: np.ndarray
    albedo: np.ndarray | float = 0.0
    emission: np.ndarray | float = 0.0
    shadows: np.ndarray | int = ALL_LINKINGS
    lit: np.ndarray | int = ALL_LINKINGS
    linking: np.ndarray | int = 0
    solid_lit: int = ALL_LINKINGS

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
        check_whole(self.solid_lit, "occluders.solid_lit", 0, ALL_LINKINGS)
        linkings = {"shadows": _whole(self.shadows, "shadows", count, ALL_LINKINGS, np.uint64),
                    "lit": _whole(self.lit, "lit", count, ALL_LINKINGS, np.uint64),
                    "linking": _whole(self.linking, "linking", count, MOST_LINKINGS - 1, np.uint8)}
        values = {"vertices": mesh.vertices, "triangles": mesh.triangles, "albedo": albedo, "emission": emission}
        for name, value in (values | linkings).items():
            object.__setattr__(self, name, value)

    @property
    def links(self) -> tuple | None:
        """(shadows, lit, linking, solid_lit), or None if all light meets everything."""
        links = self.shadows, self.lit, self.linking, self.solid_lit
        meets_all = self.solid_lit == ALL_LINKINGS and all(np.all(one == ALL_LINKINGS) for one in links[:2])
        return None if meets_all else links

    @property
    def hash(self) -> str:
        digest = hashlib.sha256()
        for array in (self.vertices, self.triangles, self.albedo, self.emission):
            digest.update(np.ascontiguousarray(array).data)
        for array in self.links or ():
            digest.update(np.asarray(array, np.uint64).data)
        return digest.hexdigest()


def _whole(values, name: str, count: int, most: int, kind: type) -> np.ndarray:
    """(count,) whole numbers in [0, most] of a type."""
    array = np.asarray(values)
    if array.dtype.kind not in "iu":
        array = np.array(values, object)  # numpy makes floats of large and small whole numbers in one list
    if array.shape not in ((), (count,)):
        raise ArgumentError(f"occluders.{name} has the shape {array.shape}: must be a number, or (m,)")
    is_whole = array.dtype.kind in "iu" or all(isinstance(one, numbers.Integral) for one in array.flat)
    if not (is_whole and int(array.min()) >= 0 and int(array.max()) <= most):
        raise ArgumentError(f"occluders.{name} = {quoted(values)}: must be whole numbers from 0 to {most}")
    return np.ascontiguousarray(np.broadcast_to(array, count), kind)


def _rows(values, name: str, count: int, most: float) -> np.ndarray:
    """(count, 3) float32 of values in [0, most]."""
    array = finite_array(values, f"occluders.{name}")
    if array.shape not in ((), (3,), (count, 3)):
        raise ArgumentError(f"occluders.{name} has the shape {array.shape}: must be a number, (3,), or (m, 3)")
    if array.min() < 0.0 or array.max() > most:
        rule = f"0 to {most:g}" if np.isfinite(most) else "0 or more"
        raise ArgumentError(f"occluders.{name} reaches from {array.min():g} to {array.max():g}: must be {rule}")
    return np.ascontiguousarray(np.broadcast_to(array, (count, 3)), np.float32)
