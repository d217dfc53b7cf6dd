# SPDX-License-Identifier: GPL-3.0-or-later
"""The points of a map: the surface below the texels of an image, or the vertices of a mesh."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from ..common.errors import ArgumentError, DustError, InteriorError
from ..interior.solid import Solid
from ..settling.mesh import Mesh, Points, checked_mesh, vertex_points
from ..settling.texels import TexelMap, spread

FAR_APART = 4.0  # in texels: two triangles that cover one texel at points farther apart overlap
MOST_OVERLAP = 0.002  # share of the texels
GRAZING = 1e-6  # cosines up to this one face away


@dataclass(frozen=True, eq=False)
class Places:
    """`points`: where light is wanted. `mask`: which texels (height, width), rows from the bottom, or which vertices
    (n,) they are, in sequence. `triangles`: of the mesh. `notes`: parts of the surface that the UV map leaves out."""

    points: Points
    mask: np.ndarray
    triangles: np.ndarray
    notes: tuple[str, ...] = ()

    @property
    def is_image(self) -> bool:
        return self.mask.ndim == 2

    def facing(self, directions: np.ndarray) -> tuple[Places, np.ndarray]:
        """The places that face `directions`, (points, 3), of any length, and the directions of these places. The other
        places have no value of their own: with black there, interpolation would darken places next to a silhouette,
        and at the edge of an island in the UV map. Raises InteriorError if no place is left."""
        along = np.einsum("ij,ij->i", self.points.normals, directions)
        faces = along > GRAZING * np.linalg.norm(self.points.normals, axis=1) * np.linalg.norm(directions, axis=1)
        if not faces.any():
            raise InteriorError("no point of the map faces the eye: must be a view of the mapped faces from outside")
        return self.only(faces), directions[faces]

    def only(self, chosen: np.ndarray) -> Places:
        """The places for which `chosen`, (points,), is true."""
        mask = self.mask.copy()
        mask[mask] = chosen
        return dataclasses.replace(self, points=Points(self.points.positions[chosen], self.points.normals[chosen]),
                                   mask=mask)

    def filled(self, values: np.ndarray, margin: int) -> np.ndarray:
        """float32: `values` (points, ...) at their texels or vertices, extended over `margin` texels, or edges of the
        mesh, 0 elsewhere. Shape: that of the mask, then the further axes of the values."""
        found = np.zeros((*self.mask.shape, *values.shape[1:]), np.float32)
        found[self.mask] = values
        if not self.is_image:
            return self._along_edges(found, margin)
        if margin:
            for place in np.ndindex(values.shape[1:]):
                layer = found[(..., *place)]  # type: ignore[arg-type]  # numpy's stubs know no mixed tuples
                layer[...] = spread(np.ascontiguousarray(layer), self.mask, margin)
        return found

    def _along_edges(self, found: np.ndarray, margin: int) -> np.ndarray:
        """Vertices without a value get the mean of their neighbours, `margin` times."""
        filled = self.mask.copy()
        first, second = self.triangles.ravel(), np.roll(self.triangles, 1, axis=1).ravel()
        for _ in range(margin if not filled.all() else 0):
            total, count = np.zeros(found.shape), np.zeros(len(filled))
            for one, other in ((first, second), (second, first)):
                known = filled[other] & ~filled[one]
                np.add.at(total, one[known], found[other[known]])
                np.add.at(count, one[known], 1.0)
            new = count > 0.0
            found[new] = total[new] / count[new].reshape(-1, *(1,) * (found.ndim - 1))
            filled |= new
        return found


def places_of(solid: Solid, uvs, size, normals) -> Places:
    """The texels of an image of this `size` over the UV map `uvs`, (triangles, 3, 2), or the vertices if `uvs` is None.
    `normals`: shading normals, as in lamina.dust.Mesh; those of corners are not used for vertices. Triangles whose
    corners all lie at one point with u < 0 are left out on purpose: no note counts them. Raises InteriorError,
    ArgumentError."""
    if not isinstance(solid, Solid):
        raise InteriorError(f"solid = {type(solid).__name__}: must be a lamina.Solid")
    if (uvs is None) != (size is None):
        raise ArgumentError("size and uvs must be given together, or neither of them for values of vertices")
    try:
        mesh = checked_mesh(Mesh(solid.vertices, solid.triangles, normals, name=solid.name), solid.name or "solid")
        return _vertices(mesh) if uvs is None else _texels(mesh, uvs, size)
    except DustError as error:
        raise InteriorError(str(error)) from None


def _vertices(mesh: Mesh) -> Places:
    by_corner = mesh.normals is not None and mesh.normals.ndim == 3
    points = vertex_points(Mesh(mesh.vertices, mesh.triangles, None, mesh.sharp_angle) if by_corner else mesh)
    mask = np.linalg.norm(points.normals, axis=1) > 0.0
    if not mask.any():
        raise InteriorError(f"{mesh.name} has no vertices with a normal: must have faces with an area")
    return Places(Points(points.positions[mask], points.normals[mask]), mask, mesh.triangles)


def _texels(mesh: Mesh, uvs, size) -> Places:
    texels = TexelMap(mesh, uvs, size)
    points, mask = texels.points()
    texels.require_texels(bool(mask.any()))
    uvs = np.asarray(uvs)
    wanted = np.flatnonzero((uvs != uvs[:, :1]).any(axis=(1, 2)) | (uvs[:, 0, 0] >= 0.0))[::-1]
    normals = mesh.normals[wanted] if mesh.normals is not None and mesh.normals.ndim == 3 else mesh.normals
    reverse = TexelMap(Mesh(mesh.vertices, mesh.triangles[wanted], normals, mesh.sharp_angle, mesh.name), uvs[wanted],
                       size)
    other, _ = reverse.points()
    notes = reverse.notes()
    # Of triangles that cover a texel, the first owns the texel; in reversed sequence, the last.
    apart = np.linalg.norm(points.positions - other.positions, axis=1)
    areas = np.maximum(points.areas, other.areas)  # type: ignore[arg-type]  # texels have areas
    overlap = int(np.count_nonzero(apart > FAR_APART * np.sqrt(areas)))
    if overlap > MOST_OVERLAP * len(apart):
        raise InteriorError(f"{mesh.name}: {overlap} of {len(apart)} texels lie on two parts of the surface, because "
                            "islands of the UV map overlap: must be unwrapped without overlaps (in Blender: after "
                            "modifiers that copy faces are applied)")
    lengths = np.linalg.norm(points.normals, axis=1)
    mask[mask] = lengths > 0.0
    points = Points(points.positions[lengths > 0.0], points.normals[lengths > 0.0])
    return Places(points, mask, mesh.triangles, notes)


def frames_about(normals: np.ndarray) -> np.ndarray:
    """(n, 3, 3): rows are two tangents and the unit normal."""
    aside = np.where(np.abs(normals[:, :1]) < 0.6, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    tangent = np.cross(normals, aside)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    return np.stack([tangent, np.cross(normals, tangent), normals], axis=1)
