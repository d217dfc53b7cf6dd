# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender meshes as plain arrays, for work in a thread."""

from dataclasses import dataclass

import numpy as np

from . import uv_maps
from .messages import RefusedError


@dataclass(frozen=True)
class Arrays:
    """vertices: (n, 3); triangles: (m, 3), counter-clockwise seen from outside; normals: (m, 3, 3) by corner,
    as in shading (sharp edges, flat faces, custom normals), or None; uvs: (m, 3, 2) by corner, or None; name:
    of the object.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    normals: np.ndarray | None = None
    uvs: np.ndarray | None = None
    name: str = ""


def vertices(mesh, matrix, scale):
    """(n, 3), transformed by a matrix and then scaled."""
    local = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", local)
    matrix = np.array(matrix, np.float64)
    return (local.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]) * scale


def triangles(mesh, matrix):
    """(m, 3), counter-clockwise seen from outside after the transformation."""
    mesh.calc_loop_triangles()
    found = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", found)
    return _turned(found.reshape(-1, 3), matrix)


def loops(mesh, matrix):
    """(m, 3), the face corner of each triangle's corner; after `triangles`."""
    found = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("loops", found)
    return _turned(found.reshape(-1, 3), matrix)


def _turned(corners, matrix):
    """Mirroring turns faces inside out; the reversed order of corners corrects that."""
    return corners[:, ::-1] if matrix.determinant() < 0.0 else corners


def corner_vertices(mesh):
    """(c,), the vertex of each face corner."""
    found = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", found)
    return found


def corner_normals(mesh, matrix):
    """Normals by face corner, of any length."""
    local = np.empty(3 * len(mesh.loops), np.float32)
    if len(mesh.loops):
        mesh.corner_normals.foreach_get("vector", local)
    return _turned_normals(local, matrix)


def face_normals(mesh, matrix):
    """Normals by face, of any length."""
    local = np.empty(3 * len(mesh.polygons), np.float32)
    mesh.polygons.foreach_get("normal", local)
    return _turned_normals(local, matrix)


def _turned_normals(local, matrix):
    """The matrix of cofactors transforms normals, also for a flattened object."""
    x, y, z = np.array(matrix, np.float64)[:3, :3].T
    cofactors = np.array([np.cross(y, z), np.cross(z, x), np.cross(x, y)])
    sign = -1.0 if matrix.determinant() < 0.0 else 1.0
    return (local.reshape(-1, 3) @ (sign * cofactors)).astype(np.float32)


def uvs(obj, mesh, name, instead):
    """(c, 2), UV coordinates by face corner of the map of this name; "": the one for rendering. Raises
    RefusedError, which ends with `instead`, what to do without the map."""
    layer = uv_maps.find(mesh, name)
    if layer is None:
        raise RefusedError(f"{uv_maps.missing(obj, name)}: unwrap it, or {instead}")
    return corner_uvs(layer)


def corner_uvs(layer):
    """(c, 2), coordinates of a UV map by face corner."""
    corners = np.empty(2 * len(layer.uv), np.float32)
    layer.uv.foreach_get("vector", corners)
    return corners.reshape(-1, 2)
