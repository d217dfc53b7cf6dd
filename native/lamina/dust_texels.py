# SPDX-License-Identifier: GPL-3.0-or-later
"""From a UV map to points for dust to settle on, and back to an image with a margin."""

from __future__ import annotations

import numpy as np

from . import rays
from .dust_mesh import Mesh, Points, checked_mesh, vertex_points
from .errors import DustError

LARGEST = 16384


def texel_points(mesh: Mesh, uvs_per_corner: np.ndarray, size: int | tuple[int, int]) -> tuple[Points, np.ndarray]:
    """(points, mask): the surface's points below the texels of an image, where a triangle covers the texel's centre.

    `uvs_per_corner`: (m, 3, 2), u to the right and v up, over [0, 1]; what lies outside is left out. `size`: of a
    square image, or (width, height), each 1 to 16384. mask: (height, width) bool, rows from the bottom, as Blender
    keeps images; points: one for each texel in the mask, row by row, with normals interpolated between the vertices'
    and the area that the texel stands for. Where triangles overlap, the lowest number has the texel. Raises
    DustError, DustUnavailable."""
    layer = rays.layer()
    mesh = checked_mesh(mesh, "mesh")
    uvs = np.ascontiguousarray(uvs_per_corner, dtype=np.float64)
    if uvs.shape != (len(mesh.triangles), 3, 2):
        raise DustError(f"uvs_per_corner has shape {uvs.shape}: must be ({len(mesh.triangles)}, 3, 2)")
    if not np.isfinite(uvs).all():
        raise DustError(f"uvs_per_corner[{np.argwhere(~np.isfinite(uvs))[0][0]}]: must be finite")
    width, height = (size, size) if not isinstance(size, tuple | list) else size
    for value in (width, height):
        if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= LARGEST:
            raise DustError(f"size = {size!r}: must be whole numbers from 1 to {LARGEST}")
    triangle, weights = layer.texels(uvs, width, height)
    mask = triangle >= 0
    corners = mesh.triangles[triangle[mask]]
    weights = weights[mask].astype(np.float64)
    shares = np.column_stack([1.0 - weights.sum(axis=1), weights])
    positions = np.einsum("tk,tkc->tc", shares, mesh.vertices[corners])
    normals = vertex_points(mesh).normals
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    unit = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0.0)
    areas = _texel_areas(mesh, uvs, width * height)[triangle[mask]]
    return Points(positions, np.einsum("tk,tkc->tc", shares, unit[corners]), areas), mask


def dilate(values: np.ndarray, mask: np.ndarray, margin: int = 4) -> np.ndarray:
    """(height, width) float32: `values`, one a texel of the mask, spread over `margin` texels around it, each the
    mean of its filled neighbours, so that filtered look-ups at seams find dust and not nothing; 0 beyond. Raises
    DustError."""
    mask = np.asarray(mask, bool)
    values = np.asarray(values, np.float32)
    if mask.ndim != 2 or values.shape != (int(mask.sum()),):
        raise DustError(f"values has shape {values.shape}: must hold one number for each texel of the mask")
    height, width = mask.shape
    image = np.zeros((height + 2, width + 2), np.float32)
    image[1:-1, 1:-1][mask] = values
    filled = np.pad(mask, 1)
    for _ in range(margin):
        total = np.zeros((height, width), np.float32)
        count = np.zeros((height, width), np.float32)
        for down in range(3):
            for right in range(3):
                part = np.s_[down:down + height, right:right + width]
                total += image[part]
                count += filled[part]
        new = (count > 0) & ~filled[1:-1, 1:-1]
        if not new.any():
            break
        image[1:-1, 1:-1][new] = total[new] / count[new]
        filled[1:-1, 1:-1] |= new
    return np.ascontiguousarray(image[1:-1, 1:-1])


def _texel_areas(mesh: Mesh, uvs: np.ndarray, texels: int) -> np.ndarray:
    """For each triangle, the area in m^2 that one texel of it stands for."""
    corners = mesh.vertices[mesh.triangles]
    world = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    u, v = uvs[:, 1] - uvs[:, 0], uvs[:, 2] - uvs[:, 0]
    flat = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) * texels
    return np.divide(world, flat, out=np.zeros_like(world), where=flat > 0.0)
