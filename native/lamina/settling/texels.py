# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of dust from a UV map, and images of dust with a margin."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..common.arguments import check_whole
from ..common.errors import DustError, quoted
from ..kinds.limits import MOST_TEXELS
from . import embree
from .corners import corners_of
from .mesh import Mesh, Points, checked_mesh, vertex_points

BAND = 1 << 19  # texels at a time
LOST = 0.02  # share of the surface without texels from which a note is added


def texel_points(mesh: Mesh, uvs_per_corner: np.ndarray, size: int | tuple[int, int]) -> tuple[Points, np.ndarray]:
    """(points, mask): the surface's points below the texels of an image, where a triangle covers the texel's centre.

    `uvs_per_corner`: (m, 3, 2), u to the right and v up, over [0, 1]; parts outside are ignored. `size`: of a square
    image, or (width, height), each 1 to 16384. mask: (height, width) bool, rows from the bottom, as in Blender's
    images. points: one for each texel in the mask, row by row, with interpolated normals of the triangle's corners (at
    sharp edges each triangle has its own) and the surface area of the texel. If triangles overlap, the texel belongs to
    the lowest number. A texel takes some 150 bytes: `settle_image` needs less for large images. Raises DustError,
    DustUnavailable."""
    embree.layer()
    texels = TexelMap(checked_mesh(mesh, "mesh"), uvs_per_corner, size)
    return texels.points()


def checked_size(size) -> tuple[int, int]:
    """(width, height) of an image. Raises DustError."""
    sides = tuple(size) if isinstance(size, tuple | list) else (size, size)
    if len(sides) != 2 or not all(isinstance(one, int) and not isinstance(one, bool) and 1 <= one <= MOST_TEXELS
                                  for one in sides):
        raise DustError(f"size = {quoted(size)}: must be one or two whole numbers from 1 to {MOST_TEXELS}")
    return sides[0], sides[1]


class TexelMap:
    """A checked mesh and its UV map over an image of `width` x `height` texels. Raises DustError, DustUnavailable."""

    def __init__(self, mesh: Mesh, uvs_per_corner: np.ndarray, size: int | tuple[int, int]):
        try:
            uvs = np.ascontiguousarray(uvs_per_corner, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise DustError(f"uvs_per_corner = {quoted(uvs_per_corner)}: must be an array of numbers") from None
        if uvs.shape != (len(mesh.triangles), 3, 2):
            raise DustError(f"uvs_per_corner has shape {uvs.shape}: must be ({len(mesh.triangles)}, 3, 2)")
        if not np.isfinite(uvs).all():
            raise DustError(f"uvs_per_corner[{np.argwhere(~np.isfinite(uvs))[0][0]}]: must be finite")
        self.width, self.height = checked_size(size)
        self._mesh, self._uvs = mesh, uvs
        self._corners = corners_of(mesh)
        normals = vertex_points(mesh, corners=self._corners).normals
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        self._normals = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0.0)
        self._areas, self._texel_areas = _areas(mesh, uvs, self.width * self.height)
        self._painted = 0.0

    def bands(self) -> Iterator[tuple[slice, Points, np.ndarray]]:
        """(rows, points, mask of these rows), from the bottom."""
        layer = embree.layer()
        rows = max(1, BAND // self.width)
        self._painted = 0.0
        for first in range(0, self.height, rows):
            count = min(rows, self.height - first)
            triangle, weights = layer.texels(self._uvs, self.width, self.height, first, count)
            mask = triangle >= 0
            points = self._points(triangle[mask], weights[mask].astype(np.float64))
            self._painted += float(self._texel_areas[triangle[mask]].sum())
            yield slice(first, first + count), points, mask

    def points(self) -> tuple[Points, np.ndarray]:
        """(points, mask) of the entire image."""
        bands = [(points, mask) for _, points, mask in self.bands()]
        joined = (np.concatenate([getattr(points, name) for points, _ in bands]) for name in
                  ("positions", "normals", "areas"))
        return Points(*joined), np.concatenate([mask for _, mask in bands])

    def _points(self, triangle: np.ndarray, weights: np.ndarray) -> Points:
        shares = np.column_stack([1.0 - weights.sum(axis=1), weights])
        positions = np.einsum("tk,tkc->tc", shares, self._mesh.vertices[self._mesh.triangles[triangle]])
        normals = np.einsum("tk,tkc->tc", shares, self._normals[self._corners.point[triangle]])
        return Points(positions, normals, self._texel_areas[triangle])

    def require_texels(self, found: bool) -> None:
        """Raises DustError, with the fault of the UV map, unless a texel was found."""
        if found:
            return
        name = self._mesh.name
        if not (self._texel_areas > 0.0).any():
            raise DustError(f"{name}: the UV map has no area, as all of its islands are points or lines: unwrap again")
        low, high = self._uvs.min(axis=(0, 1)), self._uvs.max(axis=(0, 1))
        if (high <= 0.0).any() or (low >= 1.0).any():
            raise DustError(f"{name}: the UV map lies outside the image, with u from {low[0]:.3g} to {high[0]:.3g} and "
                            f"v from {low[1]:.3g} to {high[1]:.3g}: u and v must lie in [0, 1]")
        raise DustError(f"{name}: no texel's centre of {self.width} x {self.height} lies on the UV map: must be a "
                        "larger image, or larger islands")

    def notes(self) -> tuple[str, ...]:
        """Parts of the surface that the UV map leaves out; call it after the bands."""
        whole = float(self._areas.sum())
        low, high = self._uvs.min(axis=(0, 1)), self._uvs.max(axis=(0, 1))
        outside = ((self._uvs < -1e-6) | (self._uvs > 1.0 + 1e-6)).any(axis=(1, 2))
        beyond = float(self._areas[outside].sum())
        flat = float(self._areas[self._texel_areas == 0.0].sum())
        told = []
        if beyond > LOST * whole:
            told.append(f"{100.0 * beyond / whole:.0f} % of the surface is unwrapped beyond the image (u from "
                        f"{low[0]:.3g} to {high[0]:.3g}, v from {low[1]:.3g} to {high[1]:.3g}): only u and v in "
                        "[0, 1] have texels")
        if flat > LOST * whole:
            told.append(f"{100.0 * flat / whole:.0f} % of the surface has no area in the UV map, and so no texels")
        if not told and self._painted < (1.0 - 5.0 * LOST) * whole:
            told.append(f"texels stand for {100.0 * self._painted / whole:.0f} % of the surface only: islands of the "
                        "UV map overlap, or are narrower than texels")
        return tuple(told)


def dilate(values: np.ndarray, mask: np.ndarray, margin: int = 4) -> np.ndarray:
    """(height, width) float32: `values`, one per texel of the mask, extended over `margin` texels around it. Each new
    texel is the mean of its filled neighbours, so filtered lookups at seams find dust; 0 beyond. Raises DustError,
    ArgumentError."""
    check_whole(margin, "margin", 0, MOST_TEXELS)
    mask = np.asarray(mask, bool)
    values = np.asarray(values, np.float32)
    if mask.ndim != 2 or values.shape != (int(mask.sum()),):
        raise DustError(f"values has shape {values.shape}: must hold one number for each texel of the mask")
    image = np.zeros(mask.shape, np.float32)
    image[mask] = values
    return spread(image, mask, margin)


def spread(image: np.ndarray, mask: np.ndarray, margin: int) -> np.ndarray:
    """Extends `image`, 0 outside `mask`, like `dilate`, in bands of rows. The result of a band depends on `margin` rows
    more."""
    result = np.empty_like(image)
    rows = max(1, BAND // image.shape[1])
    for first in range(0, len(image), rows):
        low = max(0, first - margin)
        grown = _grown(image[low:first + rows + margin], mask[low:first + rows + margin], margin)
        result[first:first + rows] = grown[first - low:first - low + rows]
    return result


def _grown(values: np.ndarray, mask: np.ndarray, margin: int) -> np.ndarray:
    height, width = mask.shape
    image, filled = np.pad(values, 1), np.pad(mask, 1)
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
    return image[1:-1, 1:-1]


def _areas(mesh: Mesh, uvs: np.ndarray, texels: int) -> tuple[np.ndarray, np.ndarray]:
    """For each triangle, its area in m^2, and the area per texel; 0 if the triangle has no texels."""
    corners = mesh.vertices[mesh.triangles]
    world = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    u, v = uvs[:, 1] - uvs[:, 0], uvs[:, 2] - uvs[:, 0]
    flat = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) * texels
    return 0.5 * world, np.divide(world, flat, out=np.zeros_like(world), where=flat > 0.0)
