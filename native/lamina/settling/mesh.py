# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes for dust: checks, a frame for single precision, normals and areas."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ..common.errors import DustError
from ..common.progress import Progress

FARTHEST = 1e12  # metres; beyond it even doubles do not resolve a surface well enough
MOST = 1 << 31  # vertices or triangles: the range of 32-bit indices in the core


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles in world space. vertices: (n, 3) metres; triangles: (m, 3) indices, counter-clockwise seen from
    outside. A mesh need not be closed or manifold; faces without area are ignored.

    normals: of any length; (n, 3), one per vertex; or (m, 3, 3), one for each corner of each triangle; or None:
        angle-weighted means of the faces' normals, which do not depend on the triangulation of a flat face, taken
        across all edges except sharp ones.
    sharp_angle: without given normals, an edge is sharp if the angle between the normals of its two faces is larger
        than this, in radians, [0, pi]; pi: no edge is sharp. The default, 30 degrees, is that of Blender's automatic
        smoothing.
    name: the mesh's name in messages, or ""."""

    vertices: np.ndarray
    triangles: np.ndarray
    normals: np.ndarray | None = None
    sharp_angle: float = math.radians(30.0)
    name: str = ""


@dataclass(frozen=True, eq=False)
class Corners:
    """Points of a mesh. A vertex at a sharp edge has several, one for each of its normals. Point v is the first point
    of vertex v; the further points follow.

    point: (m, 3) uint32, the point of each triangle's corners; vertex: (k,) uint32, the vertex of each point; first:
    (k,) int64, the first corner of each point, as 3 * triangle + corner, or -1 at a vertex without faces."""

    point: np.ndarray
    vertex: np.ndarray
    first: np.ndarray

    @property
    def split(self) -> bool:
        """True if some vertex has several points."""
        return len(self.vertex) > 0 and len(np.unique(self.vertex)) < len(self.vertex)


@dataclass(frozen=True, eq=False)
class Points:
    """Points of a surface. positions, normals: (n, 3); areas: (n,), the surface area in m^2 of each point, or None. A
    point with normal 0 gets no dust."""

    positions: np.ndarray
    normals: np.ndarray
    areas: np.ndarray | None = None


def checked_mesh(mesh: Mesh, name: str) -> Mesh:
    """The mesh with float64 vertices, uint32 triangles and float64 normals. Messages use the mesh's own name if it has
    one. Raises DustError."""
    if not isinstance(mesh, Mesh):
        raise DustError(f"{name} = {type(mesh).__name__}: must be a lamina.dust.Mesh")
    name = mesh.name or name
    if not isinstance(mesh.sharp_angle, int | float) or not 0.0 <= mesh.sharp_angle <= math.pi:
        raise DustError(f"{name}.sharp_angle = {mesh.sharp_angle!r}: must lie in [0, {math.pi:g}]")
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
        try:
            normals = np.asarray(mesh.normals, np.float64)
        except (TypeError, ValueError, OverflowError):
            raise DustError(f"{name}.normals: must be numbers of shape (n, 3) or (m, 3, 3)") from None
        by_corner = normals.ndim == 3
        if by_corner and normals.shape != (len(triangles), 3, 3):
            raise DustError(f"{name}.normals has shape {normals.shape}: must be ({len(triangles)}, 3, 3), or "
                            f"({len(vertices)}, 3)")
        normals = triples(normals.reshape(-1, 3) if by_corner else normals, f"{name}.normals")
        if not by_corner and len(normals) != len(vertices):
            raise DustError(f"{name}.normals has {len(normals)} rows: must have {len(vertices)} like the vertices")
        normals = normals.reshape(-1, 3, 3) if by_corner else normals
    triangles = np.ascontiguousarray(triangles, dtype=np.uint32)
    return Mesh(vertices, triangles, normals, float(mesh.sharp_angle), name)


def checked_meshes(meshes: Iterable[Mesh], name: str) -> list[Mesh]:
    """Each mesh of a list, see checked_mesh. Raises DustError."""
    if not isinstance(meshes, Iterable):
        raise DustError(f"{name} = {type(meshes).__name__}: must be a list of lamina.dust.Mesh")
    return [checked_mesh(mesh, f"{name}[{index}]") for index, mesh in enumerate(meshes)]


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
    except (TypeError, ValueError, OverflowError):
        raise DustError(f"{name}: must be numbers of shape (n, 3)") from None
    if array.size == 0:
        return np.zeros((0, 3))
    if array.ndim != 2 or array.shape[1] != 3:
        raise DustError(f"{name} has shape {array.shape}: must be (n, 3)")
    # One fast pass for valid values: NaN fails the comparison too.
    if not (max(-array.min(), array.max()) <= FARTHEST):
        row, column = np.argwhere(~(np.abs(array) <= FARTHEST))[0]
        raise DustError(f"{name}[{row}] has the coordinate {array[row, column]!s}: must lie within +-{FARTHEST:g}")
    return array


def used_vertices(mesh: Mesh) -> np.ndarray:
    """(n,) bool: true for vertices of faces."""
    used = np.zeros(len(mesh.vertices), bool)
    used[mesh.triangles.ravel()] = True
    return used


def vertex_points(mesh: Mesh, step: Progress = lambda fraction, text: None, corners: Corners | None = None) -> Points:
    """The vertices of a checked mesh, or its points if `corners` splits them, with their normals and areas, a third of
    the area of each face. Vertices without faces have normal 0 unless the mesh gives normals of vertices, and always
    area 0."""
    count = len(mesh.vertices) if corners is None else len(corners.vertex)
    areas = np.zeros(count)
    normals = np.zeros((count, 3))
    block = 1 << 20  # triangles per block, so that ten million faces do not need gigabytes
    for first in range(0, len(mesh.triangles), block):
        step(first / len(mesh.triangles), "normals")
        triangles = mesh.triangles[first:first + block]
        ends = [mesh.vertices[triangles[:, k]] for k in range(3)]
        cross = np.cross(ends[1] - ends[0], ends[2] - ends[0])
        doubled = np.linalg.norm(cross, axis=1)
        has_area = doubled > 0.0
        unit = np.divide(cross, doubled[:, None], out=np.zeros_like(cross), where=has_area[:, None])
        owners = triangles if corners is None else corners.point[first:first + block]
        for k in range(3):
            areas += np.bincount(owners[:, k], doubled / 6.0, count)
            if mesh.normals is None:
                angle = _angle(ends[(k + 1) % 3] - ends[k], ends[(k + 2) % 3] - ends[k]) * has_area
                for axis in range(3):
                    normals[:, axis] += np.bincount(owners[:, k], angle * unit[:, axis], count)
    if mesh.normals is not None:
        normals = mesh.normals if corners is None else _given_normals(mesh.normals, corners)
    return Points(mesh.vertices if corners is None else mesh.vertices[corners.vertex], normals, areas)


def _given_normals(normals: np.ndarray, corners: Corners) -> np.ndarray:
    """The normal of each point, from normals of vertices or of corners."""
    if normals.ndim == 2:
        return normals[corners.vertex]
    return np.where(corners.first[:, None] >= 0, normals.reshape(-1, 3)[corners.first], 0.0)


def unit_normals(normals: np.ndarray) -> np.ndarray:
    """(n, 3) float32 of length 1, or 0 for vectors of length 0."""
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.divide(normals, length, out=np.zeros_like(normals), where=length > 1e-30).astype(np.float32)


def _angle(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The angles between vectors, accurate for small and for flat angles."""
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.einsum("ij,ij->i", a, b))


@dataclass(frozen=True)
class Frame:
    """The frame of single-precision coordinates, (world - centre) / scale, in which the surface lies within the unit
    sphere for any position and size."""

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
    """The frame of the vertices that faces of a checked surface use. Raises DustError if the surface has no extent."""
    if not len(surface.triangles):
        raise DustError(f"{surface.name}.triangles is empty: must have at least one face for dust to settle on")
    vertices = surface.vertices[used_vertices(surface)]
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    scale = 0.5 * float(np.linalg.norm(high - low))
    if not scale > 1e-12:
        raise DustError(f"{surface.name} is {2 * scale:g} m large: must have an extent")
    return Frame(0.5 * (low + high), scale)
