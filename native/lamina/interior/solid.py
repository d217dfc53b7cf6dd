# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed meshes: repairs and checks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..common.errors import DustError, InteriorError, quoted
from ..settling.mesh import Mesh, checked_mesh

WELD = 1e-6  # relative to the mesh's size: vertices closer than this are merged
FLAT = 1e-9  # relative to the cube of the size: a smaller volume counts as 0
TRIED = 8  # faces of a shell whose middles may show that it lies inside another


@dataclass(frozen=True, eq=False)
class Solid:
    """A closed mesh in mm. vertices: (n, 3); triangles: (m, 3) indices, counter-clockwise seen from outside.

    Repaired without a message: vertices whose coordinates agree after rounding to 1e-6 of the mesh's size are merged,
    and triangles that then have a vertex twice are removed. With `fill_holes`, each hole is closed by triangles from
    its edges to the mean of its vertices; a number is the largest area of these triangles that is accepted, relative
    to that of the mesh. Parts may overlap, and cavities may lie inside. `opaque`: (m,) bool, which
    triangles absorb all light that meets them, from inside and from outside, such as faces of another, black material;
    None: none. Faces that fill holes are not opaque. `name`: name of the mesh in messages."""

    vertices: np.ndarray
    triangles: np.ndarray
    fill_holes: bool | float = False
    name: str = ""
    opaque: np.ndarray | None = None

    def is_closed(self) -> bool:
        """False for an open mesh, such as a plane. Raises InteriorError where walk_in_mesh would for a closed one: if
        it is inside out or has no volume, and for any mesh that is empty or has inconsistent orientations."""
        return not _examined(self)[1]


@dataclass(frozen=True, eq=False)
class Closed:
    """A repaired mesh. `given`: (m,) int, the triangles of the Solid that its triangles were, -1 for those that fill
    holes. `opaque`: (m,) bool. `holes`: the number of those that were filled; `filled`: their area, relative to that of
    the other triangles."""

    mesh: Mesh
    given: np.ndarray
    opaque: np.ndarray
    holes: int
    filled: float

    def notes(self) -> tuple[str, ...]:
        """A sentence about holes that were filled, if there were any."""
        if not self.holes:
            return ()
        holes = "a hole" if self.holes == 1 else f"{self.holes} holes"
        return (f"the walks close {holes} of {self.mesh.name or 'the solid'}, {100.0 * self.filled:.2g} % of the area",)


def closed(solid: Solid) -> Closed:
    """The repaired mesh. Raises InteriorError if the mesh is empty or open, if the mesh or a shell that bounds no
    cavity is inside out, if its faces have inconsistent orientations, or if `opaque` does not fit."""
    found, opening = _examined(solid)
    if opening:
        raise InteriorError(opening)
    return found


def _examined(solid: Solid) -> tuple[Closed, str]:
    """As `closed`, and '' or the sentence about an open mesh, whose side is not examined."""
    if not isinstance(solid, Solid):
        raise InteriorError(f"solid = {type(solid).__name__}: must be a lamina.Solid")
    name = solid.name or "solid"
    try:
        mesh = checked_mesh(Mesh(solid.vertices, solid.triangles, name=solid.name), name)
    except DustError as error:
        raise InteriorError(str(error)) from None
    if not len(mesh.triangles):
        raise InteriorError(f"{name}.triangles is empty: must have faces")
    opaque = _checked_opaque(solid.opaque, len(mesh.triangles), name)
    largest = _checked_share(solid.fill_holes, name)
    used = mesh.vertices[mesh.triangles.ravel()]
    size = float(np.linalg.norm(used.max(axis=0) - used.min(axis=0)))
    if not size > 0.0:
        raise InteriorError(f"{name} is 0 mm large: must have an extent")
    vertices, triangles, kept = _welded(mesh.vertices, mesh.triangles, size)
    open_edges, holes, share = _open_edges(triangles, len(vertices)), 0, 0.0
    if largest and len(open_edges) and _ends_balance(open_edges, len(vertices)):
        more, filled = _filled(vertices, triangles, open_edges)
        added = _filled_share(more, filled, len(open_edges))
        if added <= largest:
            holes, share = len(more) - len(vertices), added
            vertices, triangles = more, filled
            open_edges = _open_edges(triangles, len(vertices))
    given = np.pad(np.flatnonzero(kept), (0, len(triangles) - int(kept.sum())), constant_values=-1)
    examined = Closed(Mesh(vertices, triangles, name=solid.name), given, opaque[given] & (given >= 0), holes, share)
    if len(open_edges):
        return examined, _opening(vertices, triangles, open_edges, name)
    corners = vertices[triangles] - 0.5 * (used.max(axis=0) + used.min(axis=0))
    volumes = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
    volume = float(volumes.sum())
    if abs(volume) <= FLAT * size**3:
        raise InteriorError(f"{name} has a volume of {volume:g} mm^3: must enclose a volume")
    if volume < 0.0:
        raise InteriorError(f"{name} is inside out, with a volume of {volume:g} mm^3: flip its normals (in Blender: "
                            "Mesh > Normals > Recalculate Outside)")
    _refuse_turned_shells(corners, triangles, volumes, FLAT * size**3, name)
    return examined, ""


def _checked_opaque(opaque, count: int, name: str) -> np.ndarray:
    if opaque is None:
        return np.zeros(count, bool)
    found = np.asarray(opaque)
    if found.dtype != bool or found.shape != (count,):
        raise InteriorError(f"{name}.opaque = {quoted(opaque)}: must be {count} booleans, one per triangle, or None")
    return found


def _checked_share(fill_holes, name: str) -> float:
    """The largest area of the triangles that fill holes, relative to that of the mesh."""
    if isinstance(fill_holes, bool | np.bool_):
        return np.inf if fill_holes else 0.0
    if not isinstance(fill_holes, int | float) or not fill_holes >= 0.0:
        raise InteriorError(f"{name}.fill_holes = {quoted(fill_holes)}: must be True, False or a share of the area")
    return float(fill_holes)


def _welded(vertices, triangles, size: float):
    """(vertices, triangles, which of the given triangles these are) with vertices at equal positions merged. Vertices
    that no triangle has are left out."""
    low = vertices.min(axis=0)
    rounded = np.rint((vertices - low) / (WELD * size)).astype(np.int64)
    _, first, place = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    triangles = place.ravel()[triangles]
    a, b, c = triangles.T
    kept = (a != b) & (b != c) & (c != a)
    used, corners = np.unique(triangles[kept], return_inverse=True)
    return vertices[first[used]], np.ascontiguousarray(corners.reshape(-1, 3), np.uint32), kept


def _open_edges(triangles, count: int) -> np.ndarray:
    """Directed edges, shape (k, 2), that occur in more triangles than the opposite edge: one row for each missing
    opposite edge."""
    ends = triangles.astype(np.int64)
    edges = np.concatenate([ends[:, [0, 1]], ends[:, [1, 2]], ends[:, [2, 0]]])
    low, high = edges.min(axis=1), edges.max(axis=1)
    keys, place = np.unique(low * count + high, return_inverse=True)
    along = np.where(edges[:, 0] < edges[:, 1], 1, -1)
    balance = np.bincount(place.ravel(), along, len(keys)).astype(np.int64)
    wrong = np.flatnonzero(balance)
    pairs = np.column_stack([keys[wrong] // count, keys[wrong] % count])
    turned = np.where(balance[wrong, None] > 0, pairs, pairs[:, ::-1])
    return np.repeat(turned, np.abs(balance[wrong]), axis=0)


def _ends_balance(edges, count: int) -> bool:
    """True if at each vertex as many open edges begin as end. This holds for the boundaries of holes."""
    return bool((np.bincount(edges[:, 0], minlength=count) == np.bincount(edges[:, 1], minlength=count)).all())


def _filled(vertices, triangles, edges):
    """(vertices, triangles) with each hole closed by a fan of triangles around the mean of its vertices."""
    group = _connected(edges, len(vertices))
    holes, hole = np.unique(group[edges[:, 0]], return_inverse=True)
    hole = hole.ravel()
    counts = np.bincount(hole)[:, None]
    centres = np.column_stack([np.bincount(hole, vertices[edges[:, 0], axis]) for axis in range(3)]) / counts
    fans = np.column_stack([edges[:, 1], edges[:, 0], len(vertices) + hole])
    return np.vstack([vertices, centres]), np.ascontiguousarray(np.vstack([triangles, fans]), np.uint32)


def _filled_share(vertices, triangles, count: int) -> float:
    """The area of the last `count` triangles, relative to that of the others."""
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return float(areas[len(areas) - count:].sum() / areas[:len(areas) - count].sum())


def _connected(edges, count: int) -> np.ndarray:
    """For each vertex, the lowest vertex to which a chain of edges leads."""
    group = np.arange(count)
    first, second = edges.T
    while True:  # joins each group with a neighbour, so the number of groups halves at least
        first, second = group[first], group[second]
        apart = first != second
        first, second = first[apart], second[apart]
        if not len(first):
            return group
        np.minimum.at(group, np.maximum(first, second), np.minimum(first, second))
        while (group != group[group]).any():
            group = group[group]


def _refuse_turned_shells(corners, triangles, volumes, flat: float, name: str) -> None:
    """A shell that is inside out bounds a cavity, unless it lies outside all others. `corners`: (m, 3, 3); `volumes`:
    (m,), signed, of the tetrahedra from the origin; `flat`: a volume that counts as 0."""
    ends = triangles.astype(np.int64)
    group = _connected(np.concatenate([ends[:, [0, 1]], ends[:, [1, 2]]]), int(ends.max()) + 1)
    _, shell = np.unique(group[ends[:, 0]], return_inverse=True)
    shell = shell.ravel()
    turned = np.flatnonzero(np.bincount(shell, volumes) < -flat)
    rays = _Rays(corners) if len(turned) else None
    for one in turned:
        own = shell == one
        middles = corners[own].mean(axis=1)
        if rays and not any(rays.leave(middle, ~own) for middle in middles[::max(1, len(middles) // TRIED)]):
            raise InteriorError(f"{name} has a separate part of {len(middles)} faces that is inside out and no cavity: "
                                "flip the normals of this part (in Blender: Mesh > Normals > Flip)")


class _Rays:
    """Rays in one direction against triangles, (m, 3, 3). The direction is such that rays hit no edges of usual
    meshes."""

    def __init__(self, corners: np.ndarray):
        self._turn, _ = np.linalg.qr(np.array([[1.0, 0.31, 0.17], [0.23, 1.0, 0.41], [0.37, 0.13, 1.0]]))
        self._corners = corners @ self._turn
        self._low = np.ascontiguousarray(self._corners.min(axis=1).T)
        self._high = np.ascontiguousarray(self._corners.max(axis=1).T)

    def leave(self, point: np.ndarray, chosen: np.ndarray) -> bool:
        """True if the ray from a point leaves the `chosen` triangles' solid more often than it enters."""
        x, y, z = here = point @ self._turn
        (left, front, _), (right, back, above) = self._low, self._high
        near = chosen & (left <= x) & (x <= right) & (front <= y) & (y <= back) & (z <= above)
        ends = self._corners[near] - here
        across, up = ends[:, :, 0], ends[:, :, 1]
        a, b, c = (across[:, k] * up[:, k - 2] - up[:, k] * across[:, k - 2] for k in range(3))
        whole = a + b + c  # twice the area across the ray, positive where the ray leaves
        height = (a * ends[:, 2, 2] + b * ends[:, 0, 2] + c * ends[:, 1, 2]) * whole
        hit = (a * whole > 0.0) & (b * whole > 0.0) & (c * whole > 0.0) & (height > 0.0)
        return bool(np.sign(whole[hit]).sum() > 0.0)


def _opening(vertices, triangles, edges, name: str) -> str:
    """The sentence about an open mesh. Raises InteriorError if faces disagree along an edge."""
    ends = triangles.astype(np.int64)
    pairs = np.sort(np.concatenate([ends[:, [0, 1]], ends[:, [1, 2]], ends[:, [2, 0]]]), axis=1)
    keys, sides = np.unique(pairs[:, 0] * len(vertices) + pairs[:, 1], return_counts=True)
    here = np.sort(edges, axis=1)
    disagree = np.flatnonzero(sides[np.searchsorted(keys, here[:, 0] * len(vertices) + here[:, 1])] % 2 == 0)
    first = here[disagree[0] if len(disagree) else 0]
    where = " to ".join("({:g}, {:g}, {:g})".format(*vertices[end]) for end in first)
    if len(disagree):
        raise InteriorError(f"{name} has faces that disagree about which side is outside, as along the edge from "
                            f"{where}: make its normals consistent (in Blender: Mesh > Normals > Recalculate Outside)")
    return (f"{name} is open along {len(edges)} edges, as from {where}: close it (in Blender: Mesh > Clean Up > Fill "
            "Holes; in Python: fill_holes=True)")
