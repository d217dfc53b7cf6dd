# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated objects as plain arrays in world space, in metres, for work in a thread."""

from dataclasses import dataclass

import numpy as np

from ..base import mesh_arrays, rendered
from ..base.mesh_arrays import Arrays
from ..base.messages import RefusedError
from ..nodes import dust_playback

INSTANCES = "instances of its geometry nodes get no dust: end the nodes with Realize Instances"
MOST_TRIANGLES = 100_000_000  # of all occluders together: some 6 GB

_TAG, _FACE_TAG = "lamina_vertex", "lamina_face"


@dataclass(frozen=True)
class OwnMesh:
    """The object's own mesh, without its modifiers, in the same space. vertices: (k, 3); corners: (c,), the
    vertex of each face corner. Relation to the Arrays without modifiers: loops: (m, 3), the face corner of
    each corner of a triangle. With modifiers: normals: (c, 3); faces: (c,), the face of each face corner;
    face_normals: (f, 3); origins: (n,), the vertex of this mesh for each vertex; face_origins: (m,), the face
    of this mesh for each triangle, -1 for none; either is None if unknown. has_instances: geometry nodes make
    instances, which have no dust.
    """

    vertices: np.ndarray
    corners: np.ndarray
    loops: np.ndarray | None = None
    normals: np.ndarray | None = None
    faces: np.ndarray | None = None
    face_normals: np.ndarray | None = None
    origins: np.ndarray | None = None
    face_origins: np.ndarray | None = None
    has_instances: bool = False

    @property
    def is_lost(self):
        """True if no attribute of this mesh passes the modifiers."""
        return self.loops is None and self.origins is None and self.face_origins is None


@dataclass(frozen=True)
class Request:
    """An object whose dust is wanted. `uv_map`: that map is read too, "" is the active one; None: no map.
    `others`: other objects keep dust off."""

    obj: object
    uv_map: str | None = None
    others: bool = True


def read(context, requests, live=False):
    """[(Arrays, OwnMesh, occluders)] of each Request object as it is rendered: modifiers and transformation
    applied. The scene is evaluated once for all.

    The occluders of an object's dust, a list of Arrays, are all other objects that are rendered and cast
    shadows, also instances; none without `others`. `live`: as the viewport shows all, without a render's
    dependency graph, which takes longer and needs an idle Blender. An object that is hidden in renders is as
    the viewport shows it, too. Raises RefusedError."""
    tags = {one.obj: _tag(one.obj.data) for one in requests if _is_changed(one.obj, live)}
    scale = context.scene.unit_settings.scale_length
    with_others = any(one.others for one in requests)

    def read_from(depsgraph):
        bodies = [None if live else _body_in(depsgraph, one, scale, tags) for one in requests]
        known = {one.obj: body[0] for one, body in zip(requests, bodies, strict=True) if body is not None}
        return bodies, _all_occluders(depsgraph, scale, known) if with_others else []

    try:
        shown = rendered.viewport(context)
        bodies, others = read_from(shown) if live else rendered.visit(
            context.scene, context.view_layer, read_from)
        for number, one in enumerate(requests):
            if bodies[number] is None:
                shown = rendered.viewport(context)
                evaluated = one.obj.evaluated_get(shown)
                bodies[number] = _body(shown, one, evaluated, evaluated.matrix_world, scale, tags)
    finally:
        for obj in tags:
            for name in (_TAG, _FACE_TAG):
                if name in obj.data.attributes:  # two objects may share a mesh
                    obj.data.attributes.remove(obj.data.attributes[name])
    return [
        (*body, [arrays for other, arrays in others if other != one.obj] if one.others else [])
        for one, body in zip(requests, bodies, strict=True)
    ]


def _is_changed(obj, live):
    """True if modifiers change the mesh of an object."""
    return any(_is_used(one, obj, live) and not dust_playback.is_playback(one) for one in obj.modifiers)


def has_own_levels(obj):
    """True if renders show other modifiers, or other levels of them, than the viewport."""
    return any(
        one.show_viewport != one.show_render or getattr(one, "levels", 0) != getattr(one, "render_levels", 0)
        for one in obj.modifiers
    )


def subdivides(obj):
    """True if a modifier subdivides the mesh in renders."""
    kinds = ("SUBSURF", "MULTIRES")
    return any(one.type in kinds and one.show_render and one.render_levels for one in obj.modifiers)


def _is_used(modifier, obj, live):
    return modifier.show_viewport if live or obj.hide_render else modifier.show_render


def _body_in(depsgraph, request, scale, tags):
    """What `_body` returns, or None if the object is not seen in this dependency graph."""
    for instance in depsgraph.object_instances:
        if rendered.is_itself(instance, request.obj) and instance.show_self:
            return _body(depsgraph, request, instance.object, instance.matrix_world.copy(), scale, tags)
    return None


def _has_instances(depsgraph, obj):
    """True if the object's geometry nodes make instances. Objects that the older instancing of children
    places are no such instances."""
    return obj.instance_type == "NONE" and any(
        instance.is_instance and instance.parent is not None and instance.parent.original == obj
        for instance in depsgraph.object_instances
    )


def _body(depsgraph, request, evaluated, matrix, scale, tags):
    """(Arrays, OwnMesh). `matrix`: of the object, in world space."""
    obj, uv_map, tags = request.obj, request.uv_map, tags.get(request.obj)
    has_instances = _has_instances(depsgraph, obj)
    mesh, result = obj.data, evaluated.to_mesh()
    try:
        vertices = mesh_arrays.vertices(result, matrix, scale)
        triangles, loops = mesh_arrays.triangles(result, matrix), mesh_arrays.loops(result, matrix)
        normals, uvs = mesh_arrays.corner_normals(result, matrix)[loops], None
        if uv_map is not None:
            uvs = mesh_arrays.uvs(obj, result, uv_map, "keep the dust in an attribute")[loops]
        if tags is None:
            corners = mesh_arrays.corner_vertices(mesh)
            own = OwnMesh(vertices, corners, loops, has_instances=has_instances)
        else:
            own = _own(mesh, matrix, scale, _origins(result, tags), _face_origins(result), has_instances)
    finally:
        evaluated.to_mesh_clear()
    if not len(triangles):
        told = f": {INSTANCES}" if has_instances else ""
        raise RefusedError(f"{obj.name} has no faces for dust to settle on{told}")
    return Arrays(vertices, triangles, normals, uvs, obj.name), own


def _own(mesh, matrix, scale, origins, face_origins, has_instances):
    """The OwnMesh of an object with modifiers."""
    sizes = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_total", sizes)
    return OwnMesh(
        mesh_arrays.vertices(mesh, matrix, scale),
        mesh_arrays.corner_vertices(mesh),
        None,
        mesh_arrays.corner_normals(mesh, matrix),
        np.repeat(np.arange(len(sizes)), sizes),
        mesh_arrays.face_normals(mesh, matrix),
        origins,
        face_origins,
        has_instances,
    )


def _all_occluders(depsgraph, scale, known):
    """[(object, or None for an instance; its Arrays)] of all objects that are rendered and cast shadows, also
    instances. known: {object: its Arrays} of those that were read before. Raises RefusedError."""
    found, count = [], 0
    for instance in depsgraph.object_instances:
        other = instance.object
        if not rendered.casts_shadow(instance) or not other.original.lamina_dust.stops:
            continue
        own = None if instance.is_instance else other.original
        arrays = known.get(own)
        if arrays is None:
            mesh = other.to_mesh()
            if mesh is None:
                continue
            try:
                vertices = mesh_arrays.vertices(mesh, instance.matrix_world, scale)
                triangles = mesh_arrays.triangles(mesh, instance.matrix_world)
            finally:
                other.to_mesh_clear()
        else:
            vertices, triangles = arrays.vertices, arrays.triangles
        count += len(triangles)
        if count > MOST_TRIANGLES:
            text = f"The other objects have more than {MOST_TRIANGLES:,} triangles: hide some in renders"
            raise RefusedError(text)
        if len(triangles):
            found.append((own, Arrays(vertices, triangles, name=other.name)))
    return found


def _tag(mesh):
    """Gives each vertex random numbers that differ from all blends of other vertices, to recognise it behind
    modifiers, and each face its number, counted from 1."""
    tags = np.random.default_rng(len(mesh.vertices)).random((len(mesh.vertices), 3), np.float32)
    numbers = np.arange(1, len(mesh.polygons) + 1, dtype=np.int32)
    for name, kind, domain, key, values in (
        (_TAG, "FLOAT_VECTOR", "POINT", "vector", tags), (_FACE_TAG, "INT", "FACE", "value", numbers)
    ):
        if name in mesh.attributes:
            mesh.attributes.remove(mesh.attributes[name])
        mesh.attributes.new(name, kind, domain).data.foreach_set(key, values.ravel())
    return tags


def _face_origins(mesh):
    """(m,), the tagged face of each triangle, -1 for none; None if the tags are lost."""
    attribute = mesh.attributes.get(_FACE_TAG)
    if attribute is None or (attribute.domain, attribute.data_type) != ("FACE", "INT"):
        return None
    found = np.empty(len(mesh.polygons), np.int32)
    attribute.data.foreach_get("value", found)
    polygons = np.empty(len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("polygon_index", polygons)
    return found[polygons] - 1


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
