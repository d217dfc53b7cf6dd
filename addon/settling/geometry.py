# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated objects as plain arrays in world space, in metres, for work in a thread."""

from dataclasses import dataclass

import numpy as np

from ..base import mesh_arrays
from ..base.mesh_arrays import Arrays
from ..base.messages import RefusedError
from ..nodes import dust_playback

KINDS = ("MESH", "CURVE", "SURFACE", "META", "FONT")
MOST_TRIANGLES = 100_000_000  # of all occluders together: some 6 GB

_TAG = "lamina_vertex"


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
    changed = any(one.show_viewport and not dust_playback.is_playback(one) for one in obj.modifiers)
    tags = _tag(mesh) if changed else None
    try:
        depsgraph = context.evaluated_depsgraph_get()
        depsgraph.update()
        evaluated = obj.evaluated_get(depsgraph)
        result = evaluated.to_mesh()
        try:
            matrix = evaluated.matrix_world
            vertices = mesh_arrays.vertices(result, matrix, scale)
            triangles, loops = mesh_arrays.triangles(result, matrix), mesh_arrays.loops(result, matrix)
            normals, uvs = mesh_arrays.corner_normals(result, matrix)[loops], None
            if uv_map is not None:
                uvs = mesh_arrays.uvs(obj, result, uv_map, "keep the dust in an attribute")[loops]
            own = OwnMesh(
                mesh_arrays.vertices(mesh, matrix, scale),
                mesh_arrays.corner_vertices(mesh),
                mesh_arrays.corner_normals(mesh, matrix),
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
            vertices = mesh_arrays.vertices(mesh, instance.matrix_world, scale)
            triangles = mesh_arrays.triangles(mesh, instance.matrix_world)
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
