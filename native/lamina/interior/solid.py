# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed meshes: repairs and checks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..common.errors import DustError, InteriorError
from ..settling.mesh import Mesh, checked_mesh

WELD = 1e-6  # relative to the mesh's size: vertices closer than this are merged
FLAT = 1e-9  # relative to the cube of the size: a smaller volume counts as 0


@dataclass(frozen=True, eq=False)
class Solid:
    """A closed mesh in mm. vertices: (n, 3); triangles: (m, 3) indices, counter-clockwise seen from outside.

    Repaired without a message: vertices whose coordinates agree after rounding to 1e-6 of the mesh's size are merged,
    and triangles that then have a vertex twice are removed. With `fill_holes`, each hole is closed by triangles from
    its edges to the mean of its vertices. Parts may overlap, and cavities may lie inside. `name`: name of the mesh in
    messages."""

    vertices: np.ndarray
    triangles: np.ndarray
    fill_holes: bool = False
    name: str = ""


def closed(solid: Solid) -> Mesh:
    """The repaired mesh. Raises InteriorError if the mesh is empty, open or inside out, or if its faces have
    inconsistent orientations."""
    if not isinstance(solid, Solid):
        raise InteriorError(f"solid = {type(solid).__name__}: must be a lamina.Solid")
    name = solid.name or "solid"
    try:
        mesh = checked_mesh(Mesh(solid.vertices, solid.triangles, name=solid.name), name)
    except DustError as error:
        raise InteriorError(str(error)) from None
    if not len(mesh.triangles):
        raise InteriorError(f"{name}.triangles is empty: must have faces")
    used = mesh.vertices[mesh.triangles.ravel()]
    size = float(np.linalg.norm(used.max(axis=0) - used.min(axis=0)))
    if not size > 0.0:
        raise InteriorError(f"{name} is 0 mm large: must have an extent")
    vertices, triangles = _welded(mesh.vertices, mesh.triangles, size)
    open_edges = _open_edges(triangles, len(vertices))
    if solid.fill_holes and len(open_edges) and _ends_balance(open_edges, len(vertices)):
        vertices, triangles = _filled(vertices, triangles, open_edges)
        open_edges = _open_edges(triangles, len(vertices))
    if len(open_edges):
        _refuse_open(vertices, triangles, open_edges, name)
    corners = vertices[triangles] - 0.5 * (used.max(axis=0) + used.min(axis=0))
    volume = float(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))) / 6.0
    if abs(volume) <= FLAT * size**3:
        raise InteriorError(f"{name} has a volume of {volume:g} mm^3: must enclose a volume")
    if volume < 0.0:
        raise InteriorError(f"{name} is inside out, with a volume of {volume:g} mm^3: flip its normals (in Blender: "
                            "Mesh > Normals > Recalculate Outside)")
    return Mesh(vertices, triangles, name=solid.name)


def _welded(vertices, triangles, size: float):
    """(vertices, triangles) with vertices at equal positions merged."""
    low = vertices.min(axis=0)
    rounded = np.rint((vertices - low) / (WELD * size)).astype(np.int64)
    _, first, place = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    triangles = place.ravel()[triangles]
    a, b, c = triangles.T
    kept = triangles[(a != b) & (b != c) & (c != a)]
    return vertices[first], np.ascontiguousarray(kept, np.uint32)


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
    group = np.arange(len(vertices))
    while True:  # label each connected chain of edges by its lowest vertex
        lower = group.copy()
        np.minimum.at(lower, edges[:, 0], group[edges[:, 1]])
        np.minimum.at(lower, edges[:, 1], group[edges[:, 0]])
        lower = lower[lower]
        if (lower == group).all():
            break
        group = lower
    holes, hole = np.unique(group[edges[:, 0]], return_inverse=True)
    hole = hole.ravel()
    counts = np.bincount(hole)[:, None]
    centres = np.column_stack([np.bincount(hole, vertices[edges[:, 0], axis]) for axis in range(3)]) / counts
    fans = np.column_stack([edges[:, 1], edges[:, 0], len(vertices) + hole])
    return np.vstack([vertices, centres]), np.ascontiguousarray(np.vstack([triangles, fans]), np.uint32)


def _refuse_open(vertices, triangles, edges, name: str) -> None:
    ends = triangles.astype(np.int64)
    pairs = np.sort(np.concatenate([ends[:, [0, 1]], ends[:, [1, 2]], ends[:, [2, 0]]]), axis=1)
    keys, sides = np.unique(pairs[:, 0] * len(vertices) + pairs[:, 1], return_counts=True)
    here = np.sort(edges[0])
    where = " to ".join("({:g}, {:g}, {:g})".format(*vertices[end]) for end in here)
    if sides[np.searchsorted(keys, here[0] * len(vertices) + here[1])] % 2 == 0:
        raise InteriorError(f"{name} has faces that disagree about which side is outside, as along the edge from "
                            f"{where}: make its normals consistent (in Blender: Mesh > Normals > Recalculate Outside)")
    raise InteriorError(f"{name} is open along {len(edges)} edges, as from {where}: close it (in Blender: Mesh > Clean "
                        "Up > Fill Holes), or set fill_holes")
