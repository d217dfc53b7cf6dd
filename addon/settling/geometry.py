# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated objects as plain arrays in world space, in metres, for work in a thread."""

from dataclasses import dataclass

import numpy as np

from ..base import uv_maps
from ..base.messages import RefusedError

KINDS = ("MESH", "CURVE", "SURFACE", "META", "FONT")
MOST_TRIANGLES = 100_000_000  # of all occluders together: some 6 GB

_TAG = "lamina_vertex"


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


@dataclass(frozen=True)
class OwnMesh:
    """The object's own mesh, without its modifiers, in the same space. vertices: (k, 3); corners: (c,), the
    vertex of each face corner; normals: (c, 3). Relation to the Arrays: loops: (m, 3), the face corner of
    each corner of a triangle, or None with modifiers; origins: (n,), with modifiers, the vertex of this mesh
    for each vertex, -1 for none, or None if unknown.
    """

    vertices: np.ndarray
    corners: np.ndarray
    normals: np.ndarray
    loops: np.ndarray | None = None
    origins: np.ndarray | None = None


def of_object(context, obj, uv_map=None):
    """(Arrays, OwnMesh) of an object as it is rendered: modifiers and transformation applied. `uv_map`: also
    that map, "" is the active one. Raises RefusedError.
    """
    scale = context.scene.unit_settings.scale_length
    mesh = obj.data
    tags = _tag(mesh) if any(modifier.show_viewport for modifier in obj.modifiers) else None
    try:
        depsgraph = context.evaluated_depsgraph_get()
        depsgraph.update()
        evaluated = obj.evaluated_get(depsgraph)
        result = evaluated.to_mesh()
        try:
            matrix = evaluated.matrix_world
            vertices, triangles = _arrays(result, matrix, scale)
            loops = _loops(result, matrix.determinant() < 0.0)
            normals = _corner_normals(result, matrix)[loops]
            uvs = None if uv_map is None else _uvs(obj, result, uv_map)[loops]
            own = OwnMesh(
                _vertices(mesh, matrix, scale),
                _corner_vertices(mesh),
                _corner_normals(mesh, matrix),
                loops if tags is None else None,
                None if tags is None else _origins(result, tags),
            )
        finally:
            evaluated.to_mesh_clear()
    finally:
        if tags is not None:
            mesh.attributes.remove(mesh.attributes[_TAG])
    if not len(triangles):
        raise RefusedError(f"{obj.name} has no faces for dust to settle on")
    return Arrays(vertices, triangles, normals, uvs, obj.name), own


def others(context, obj):
    """The occluders of dust on `obj`: all objects that are rendered and cast shadows, also instances. Raises
    RefusedError.
    """
    scale = context.scene.unit_settings.scale_length
    found, count = [], 0
    for instance in context.evaluated_depsgraph_get().object_instances:
        other = instance.object
        if other.type not in KINDS or not _stops(instance) or _is_itself(instance, obj):
            continue
        mesh = other.to_mesh()
        if mesh is None:
            continue
        try:
            vertices, triangles = _arrays(mesh, instance.matrix_world, scale)
        finally:
            other.to_mesh_clear()
        count += len(triangles)
        if count > MOST_TRIANGLES:
            text = f"The other objects have more than {MOST_TRIANGLES:,} triangles: hide some in renders"
            raise RefusedError(text)
        if len(triangles):
            found.append(Arrays(vertices, triangles, name=other.name))
    return found


def _stops(instance):
    other = instance.object.original
    if other.hide_render or not other.visible_shadow or not other.lamina_dust.stops:
        return False
    return instance.is_instance or instance.show_self


def _is_itself(instance, obj):
    return not instance.is_instance and instance.object.original == obj


def _vertices(mesh, matrix, scale):
    local = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", local)
    matrix = np.array(matrix, np.float64)
    return (local.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]) * scale


def _arrays(mesh, matrix, scale):
    vertices = _vertices(mesh, matrix, scale)
    mesh.calc_loop_triangles()
    triangles = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    triangles = triangles.reshape(-1, 3)
    # Mirroring turns faces inside out; the reversed order of vertices corrects that.
    return vertices, triangles[:, ::-1] if matrix.determinant() < 0.0 else triangles


def _loops(mesh, mirrored):
    """The face corner of each triangle's corner."""
    loops = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("loops", loops)
    loops = loops.reshape(-1, 3)
    return loops[:, ::-1] if mirrored else loops


def _corner_vertices(mesh):
    found = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", found)
    return found


def _corner_normals(mesh, matrix):
    """Normals by face corner, of any length. The matrix of cofactors transforms them, also for a flattened
    object."""
    local = np.empty(3 * len(mesh.loops), np.float32)
    if len(mesh.loops):
        mesh.corner_normals.foreach_get("vector", local)
    x, y, z = np.array(matrix, np.float64)[:3, :3].T
    cofactors = np.array([np.cross(y, z), np.cross(z, x), np.cross(x, y)])
    sign = -1.0 if matrix.determinant() < 0.0 else 1.0
    return (local.reshape(-1, 3) @ (sign * cofactors)).astype(np.float32)


def _uvs(obj, mesh, name):
    """UV coordinates by face corner."""
    layer = uv_maps.find(mesh, name)
    if layer is None:
        raise RefusedError(f"{uv_maps.missing(obj, name)}: unwrap it, or keep the dust in an attribute")
    corners = np.empty(2 * len(layer.uv), np.float32)
    layer.uv.foreach_get("vector", corners)
    return corners.reshape(-1, 2)


def _tag(mesh):
    """Gives each vertex random numbers that differ from all blends of other vertices, to recognise it behind
    modifiers."""
    tags = np.random.default_rng(len(mesh.vertices)).random((len(mesh.vertices), 3), np.float32)
    if _TAG in mesh.attributes:
        mesh.attributes.remove(mesh.attributes[_TAG])
    attribute = mesh.attributes.new(_TAG, "FLOAT_VECTOR", "POINT")
    attribute.data.foreach_set("vector", tags.ravel())
    return tags


def _origins(mesh, tags):
    attribute = mesh.attributes.get(_TAG)
    if attribute is None or attribute.domain != "POINT" or not len(tags):
        return None
    found = np.empty(3 * len(mesh.vertices), np.float32)
    attribute.data.foreach_get("vector", found)
    found = found.reshape(-1, 3)
    order = np.argsort(tags[:, 0])
    places = np.searchsorted(tags[order, 0], found[:, 0]).clip(0, len(tags) - 1)
    nearest = order[places]
    return np.where((tags[nearest] == found).all(axis=1), nearest, -1)
