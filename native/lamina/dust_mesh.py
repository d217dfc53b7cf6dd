# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that dust falls on: checked, brought into one frame that floats resolve, with normals and areas."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .errors import DustError
from .progress import Progress

FARTHEST = 1e12  # metres; beyond it not even doubles resolve what dust needs
MOST = 1 << 31  # vertices, triangles: what 32-bit indices of the core can count


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles in world space. vertices: (n, 3) metres; triangles: (m, 3) indices, counter-clockwise seen from
    outside; normals: (n, 3), one a vertex, of any length, or None: angle-weighted means of the faces' (they do not
    depend on how a flat face is cut). Need not be closed or manifold; faces without area take part in nothing."""

    vertices: np.ndarray
    triangles: np.ndarray
    normals: np.ndarray | None = None


@dataclass(frozen=True, eq=False)
class Points:
    """Points of a surface. positions, normals: (n, 3); areas: (n,) in m^2 that each stands for, or None. A point
    whose normal is zero gets no dust."""

    positions: np.ndarray
    normals: np.ndarray
    areas: np.ndarray | None = None


def checked_mesh(mesh: Mesh, name: str) -> Mesh:
    """The mesh with float64 vertices, uint32 triangles and float64 normals. Raises DustError."""
    if not isinstance(mesh, Mesh):
        raise DustError(f"{name} = {type(mesh).__name__}: must be a lamina.dust.Mesh")
    vertices = triples(mesh.vertices, f"{name}.vertices")
    triangles = np.asarray(mesh.triangles)
    if triangles.size == 0:
        triangles = np.zeros((0, 3), np.uint32)
    if triangles.ndim != 2 or triangles.shape[1] != 3 or triangles.dtype.kind not in "iu":
        raise DustError(f"{name}.triangles has shape {triangles.shape} of {triangles.dtype}: must be whole numbers "
                        "of shape (m, 3)")
    if max(len(vertices), len(triangles)) >= MOST:
        raise DustError(f"{name} has {max(len(vertices), len(triangles))} elements: must have less than 2^31")
    if len(triangles):
        low, high = int(triangles.min()), int(triangles.max())
        if low < 0 or high >= len(vertices):
            worst = low if low < 0 else high
            row = int(np.argmax((triangles == worst).any(axis=1)))
            raise DustError(f"{name}.triangles[{row}] has index {worst}: must lie in [0, {len(vertices) - 1}]")
    normals = None
    if mesh.normals is not None:
        normals = triples(mesh.normals, f"{name}.normals")
        if len(normals) != len(vertices):
            raise DustError(f"{name}.normals has {len(normals)} rows: must have {len(vertices)} like the vertices")
    return Mesh(vertices, np.ascontiguousarray(triangles, dtype=np.uint32), normals)


def check_points(points, name: str = "points") -> Points:
    """Points with float64 arrays, from Points or (positions, normals[, areas]). Raises DustError."""
    if not isinstance(points, Points):
        if not isinstance(points, tuple | list) or len(points) not in (2, 3):
            raise DustError(f"{name} = {type(points).__name__}: must be lamina.dust.Points or (positions, normals)")
        points = Points(*points)
    positions, normals = triples(points.positions, f"{name}.positions"), triples(points.normals, f"{name}.normals")
    if len(positions) != len(normals):
        raise DustError(f"{name}.normals has {len(normals)} rows: must have {len(positions)} like the positions")
    areas = points.areas
    if areas is not None:
        areas = np.asarray(areas, np.float64)
        if areas.shape != (len(positions),) or not (np.isfinite(areas).all() and (areas >= 0.0).all()):
            raise DustError(f"{name}.areas: must be {len(positions)} numbers of at least 0")
    return Points(positions, normals, areas)


def triples(values, name: str) -> np.ndarray:
    """(n, 3) float64, each finite and within FARTHEST. Raises DustError."""
    try:
        array = np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise DustError(f"{name}: must be numbers of shape (n, 3)") from None
    if array.size == 0:
        return np.zeros((0, 3))
    if array.ndim != 2 or array.shape[1] != 3:
        raise DustError(f"{name} has shape {array.shape}: must be (n, 3)")
    # One pass that is fast when all is well: NaN fails the comparison too.
    if not (max(-array.min(), array.max()) <= FARTHEST):
        row, column = np.argwhere(~(np.abs(array) <= FARTHEST))[0]
        raise DustError(f"{name}[{row}] has the coordinate {array[row, column]!s}: must lie within +-{FARTHEST:g}")
    return array


def used_vertices(mesh: Mesh) -> np.ndarray:
    """(n,) bool: which vertices are of some face."""
    used = np.zeros(len(mesh.vertices), bool)
    used[mesh.triangles.ravel()] = True
    return used


def vertex_points(mesh: Mesh, step: Progress = lambda fraction, text: None) -> Points:
    """The vertices of a checked mesh with their normals and the areas they stand for, a third of each of their
    faces'. Vertices of no face have normal 0 unless the mesh gives normals, and area 0 in any case."""
    count = len(mesh.vertices)
    areas = np.zeros(count)
    normals = np.zeros((count, 3))
    block = 1 << 20  # triangles at a time: ten million faces must not need gigabytes here
    for first in range(0, len(mesh.triangles), block):
        step(first / len(mesh.triangles), "normals")
        triangles = mesh.triangles[first:first + block]
        corners = [mesh.vertices[triangles[:, k]] for k in range(3)]
        cross = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        doubled = np.linalg.norm(cross, axis=1)
        has_area = doubled > 0.0
        unit = np.divide(cross, doubled[:, None], out=np.zeros_like(cross), where=has_area[:, None])
        for k in range(3):
            areas += np.bincount(triangles[:, k], doubled / 6.0, count)
            if mesh.normals is None:
                angle = _angle(corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]) * has_area
                for axis in range(3):
                    normals[:, axis] += np.bincount(triangles[:, k], angle * unit[:, axis], count)
    return Points(mesh.vertices, normals if mesh.normals is None else mesh.normals, areas)


def unit_normals(normals: np.ndarray) -> np.ndarray:
    """(n, 3) float32 of length 1, or 0 where there is none."""
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.divide(normals, length, out=np.zeros_like(normals), where=length > 1e-30).astype(np.float32)


def _angle(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Between vectors, exact for small and for flat angles."""
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.einsum("ij,ij->i", a, b))


@dataclass(frozen=True)
class Frame:
    """Where single precision is spent: coordinates are (world - centre) / scale, so that the surface lies within
    the unit sphere, wherever it is and however large."""

    centre: np.ndarray
    scale: float

    def floats(self, positions: np.ndarray) -> np.ndarray:
        """(n, 3) float32."""
        result = np.empty(positions.shape, np.float32)
        for first in range(0, len(positions), 1 << 20):
            part = slice(first, first + (1 << 20))
            result[part] = (positions[part] - self.centre) / self.scale
        return result


def common_frame(surface: Mesh) -> Frame:
    """Of the vertices that faces of a checked surface use. Raises DustError when it has no extent."""
    if not len(surface.triangles):
        raise DustError("surface.triangles is empty: must have at least one face for dust to settle on")
    vertices = surface.vertices[used_vertices(surface)]
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    scale = 0.5 * float(np.linalg.norm(high - low))
    if not scale > 1e-12:
        raise DustError(f"surface is {2 * scale:g} m large: must have an extent")
    return Frame(0.5 * (low + high), scale)
