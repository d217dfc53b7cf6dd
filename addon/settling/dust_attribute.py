# SPDX-License-Identifier: GPL-3.0-or-later
"""Settled dust as attributes of an object's own mesh: of its vertices, or of its face corners if vertices at
sharp edges have several values.
"""

import numpy as np
from mathutils import kdtree

from ..base.messages import RefusedError
from ..kinds.dust import ATTRIBUTE, BACK_ATTRIBUTE

NEAR = 8  # number of nearest rendered vertices to try for a corner without its own vertex behind modifiers
REACH = 2.0  # times the distance of the nearest rendered corner: others that are tried
ALIKE = 0.1  # largest difference of the cosines of normals


def check_names(mesh):
    """Raises RefusedError if an attribute of another kind has one of our names."""
    for name in (ATTRIBUTE, BACK_ATTRIBUTE):
        if name in mesh.attributes and not _is_ours(mesh.attributes[name]):
            text = f"{mesh.name} has another kind of attribute named {name}: rename or remove it"
            raise RefusedError(text)


def remove(mesh):
    """Remove the dust. Attributes of another kind that have one of our names stay."""
    for name in (ATTRIBUTE, BACK_ATTRIBUTE):
        if name in mesh.attributes and _is_ours(mesh.attributes[name]):
            mesh.attributes.remove(mesh.attributes[name])


def _is_ours(attribute):
    return attribute.data_type == "FLOAT" and attribute.domain in ("POINT", "CORNER")


def write(mesh, surface, own, dust):
    """Store lamina's Dust on `surface` as attributes of `mesh`, which `own` describes: of face corners if
    corners of one vertex take their dust from different points of the surface, otherwise of vertices.
    """
    places = Places(surface, own, dust)
    remove(mesh)
    store(mesh, (ATTRIBUTE, BACK_ATTRIBUTE), places, dust, places.split)
    mesh.update()


def store(mesh, names, places, dust, split):
    """Make the attributes of dust on front faces and, of two-sided dust, on back faces; `split`: of corners.
    """
    front = dust.tau if dust.back is None else dust.tau - dust.back
    for name, values in zip(names, (front, dust.back), strict=True):
        if values is not None:
            attribute = mesh.attributes.new(name, "FLOAT", "CORNER" if split else "POINT")
            chosen = values[places.by_corner if split else places.of_vertex]
            attribute.data.foreach_set("value", np.ascontiguousarray(chosen, np.float32))


class Places:
    """Indices of the values of lamina's Dust for each corner and each vertex of a mesh. `split`: corners of
    one vertex have different values."""

    def __init__(self, surface, own, dust):
        place = _places(surface, own, dust)
        self.by_corner, vertices = place[:len(own.corners)], own.corners
        self.of_vertex = np.zeros(len(own.vertices), np.int64)
        self.of_vertex[vertices[::-1]] = self.by_corner[::-1]
        self.of_vertex[_loose(own)] = place[len(own.corners):]
        self.split = bool((self.by_corner != self.of_vertex[vertices]).any())


def _loose(own):
    """Vertices without faces."""
    return np.flatnonzero(np.bincount(own.corners, minlength=len(own.vertices)) == 0)


def _places(surface, own, dust):
    """Indices of the dust's values: for each corner of the own mesh, then for each of its loose vertices."""
    loose = _loose(own)
    if own.loops is not None:
        found = np.zeros(len(own.corners) + len(loose), np.int64)
        found[own.loops.ravel()] = dust.corners.ravel()
        found[len(own.corners):] = loose
        return found
    vertices = np.concatenate([own.corners, loose])
    normals = _unit(np.concatenate([own.normals, np.zeros((len(loose), 3), np.float32)]))
    on_points = np.zeros((len(dust.tau), 3), np.float32)
    on_points[dust.corners.ravel()] = surface.normals.reshape(-1, 3)
    on_points = _unit(on_points)
    found = np.full(len(vertices), -1, np.int64)
    if own.face_origins is not None:
        if own.origins is not None:
            asking, asked = _same_corners(surface, own, dust)
            _choose(found, asking, asked, _cosines(normals, asking, on_points, asked, np.abs), dust.tau)
        lost = np.flatnonzero(found[:len(own.corners)] < 0)
        asking, asked = _on_same_faces(surface, own, dust, lost)
        faces = _unit(own.face_normals)[own.faces]
        _choose(found, asking, asked, _cosines(faces, asking, on_points, asked), dust.tau)
    if own.origins is not None:
        lost = np.flatnonzero(found < 0)
        asking, asked = _matches(vertices[lost], own.origins[dust.vertices])
        asking = lost[asking]
        _choose(found, asking, asked, _cosines(normals, asking, on_points, asked, np.abs), dust.tau)
    lost = np.flatnonzero(found < 0)
    if len(lost):
        asking, asked = _neighbours(surface, own.vertices[vertices[lost]], lost, dust.vertices)
        _choose(found, asking, asked, _cosines(normals, asking, on_points, asked), dust.tau)
    return found


def _same_corners(surface, own, dust):
    """(asking, asked): for each corner of the own mesh, the points of the rendered corners that are of the
    same vertex and the same face."""
    count = np.int64(len(own.vertices))
    face, vertex = np.repeat(own.face_origins, 3), own.origins[surface.triangles.ravel()]
    keys = np.where((face >= 0) & (vertex >= 0), face * count + vertex, -1)
    asking, corner = _matches(own.faces * count + own.corners, keys)
    return asking, dust.corners.ravel()[corner]


def _on_same_faces(surface, own, dust, lost):
    """(asking, asked): for each number of a corner in `lost`, the points of the nearest rendered corners of
    the same face."""
    asking, corner = _matches(own.faces[lost], np.repeat(own.face_origins, 3))
    places = surface.vertices[surface.triangles.ravel()[corner]]
    distance = np.linalg.norm(places - own.vertices[own.corners[lost]][asking], axis=1)
    nearest = np.full(len(lost), np.inf)
    np.minimum.at(nearest, asking, distance)
    near = distance <= REACH * nearest[asking] + 1e-12
    return lost[asking[near]], dust.corners.ravel()[corner[near]]


def _matches(wanted, given):
    """(asking, asked): all pairs of a place in `wanted` and one in `given` with the same number."""
    order = np.argsort(given, kind="stable")
    first = np.searchsorted(given[order], wanted, side="left")
    counts = np.searchsorted(given[order], wanted, side="right") - first
    asking = np.repeat(np.arange(len(wanted)), counts)
    before = np.repeat(np.cumsum(counts) - counts, counts)
    return asking, order[np.repeat(first, counts) + np.arange(len(asking)) - before]


def _cosines(normals, asking, on_points, asked, of=np.asarray):
    return of(np.einsum("ij,ij->i", normals[asking], on_points[asked]))


def _choose(found, asking, asked, cosine, tau):
    """For each asking point, of the candidates with nearly the most similar normal, the candidate with the
    most dust: both sides of a shell belong to one vertex.
    """
    best = np.full(len(found), -2.0)
    np.maximum.at(best, asking, cosine)
    alike = cosine >= best[asking] - ALIKE
    asking, asked = asking[alike], asked[alike]
    order = np.lexsort((-asked, tau[asked], asking))
    found[asking[order]] = asked[order]  # the last assignment of each wins


def _neighbours(surface, places, numbers, vertex_of_point):
    """(asking, asked): for each number, the points of the nearest rendered vertices."""
    tree = kdtree.KDTree(len(surface.vertices))
    for index, place in enumerate(surface.vertices):
        tree.insert(place, index)
    tree.balance()
    order = np.argsort(vertex_of_point, kind="stable")
    start = np.searchsorted(vertex_of_point[order], np.arange(len(surface.vertices) + 1))
    asking, asked = [], []
    for number, place in zip(numbers, places, strict=True):
        near = tree.find_n(place, NEAR)
        reach = REACH * near[0][2] + 1e-12
        for _, index, distance in near:
            if distance <= reach:
                points = order[start[index]:start[index + 1]]
                asking += [number] * len(points)
                asked += points.tolist()
    return np.array(asking, np.int64), np.array(asked, np.int64)


def _unit(normals):
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.divide(normals, length, out=np.zeros_like(normals), where=length > 0.0)
