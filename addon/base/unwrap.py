# SPDX-License-Identifier: GPL-3.0-or-later
"""Automatic UV maps without overlaps, by Blender's Smart UV Project on a copy of the mesh."""

import bpy
import numpy as np
from mathutils import Matrix

from . import editable, mesh_arrays, native
from .messages import RefusedError

NAME = "Lamina"  # of the UV map
# Limit of the angle in radians, small enough that islands of curved handles do not fold over; margin between
# islands, relative to the image.
ANGLE, MARGIN = 0.8, 0.01
# A map is unwrapped again if its texels stand for a smaller share of the surface, in an image of this size.
LEAST_SHARE, SIZE = 0.98, 512


def ensure(obj):
    """Make the UV map `NAME` of a mesh object if it is missing, or if it no longer fits the mesh because
    faces were added. The selection, the mode and other UV maps are not changed. Returns the name. Raises
    RefusedError, NativeMissingError."""
    mesh = obj.data
    layer = mesh.uv_layers.get(NAME)
    if layer is not None and mesh.polygons and fits(mesh):
        return NAME
    check(obj)
    corners = _projected(mesh)
    layer = mesh.uv_layers.get(NAME) or mesh.uv_layers.new(name=NAME, do_init=False)
    if layer is None or len(corners) != 2 * len(mesh.loops):
        raise RefusedError(f"{obj.name} cannot get another UV map: remove one, or choose one of its own")
    layer.uv.foreach_set("vector", corners)
    mesh.update()
    return layer.name


def check(obj):
    """Raises RefusedError if the mesh of an object cannot be unwrapped now."""
    if not obj.data.is_editable:
        raise RefusedError(f"{obj.name} is linked from another file: edit it there, or make it local")
    if not obj.data.polygons:
        raise RefusedError(f"{obj.name} has no faces that could be unwrapped")
    editable.require_no_edit_mode(obj)


def copying_modifier(obj):
    """The name of a modifier whose faces have no places of their own in any UV map of the mesh, so that no
    unwrap of the mesh can help; or ''. The modifiers are those of the render, or of the viewport if the
    object is hidden in renders."""
    for modifier in obj.modifiers:
        shown = modifier.show_viewport if obj.hide_render else modifier.show_render
        if shown and _copies(obj, modifier):
            return modifier.name
    return ""


def _copies(obj, modifier):
    """True if a modifier surely makes faces over the UV coordinates of others, or without any. Offsets in the
    UV map, and an inner side with a material of its own, can prevent that."""
    if modifier.type == "MIRROR":
        moved = (modifier.offset_u, modifier.offset_v, modifier.mirror_offset_u, modifier.mirror_offset_v)
        flips = modifier.use_mirror_u or modifier.use_mirror_v or modifier.use_mirror_udim
        return any(modifier.use_axis) and not any(moved) and not flips
    if modifier.type == "ARRAY":
        single = modifier.fit_type == "FIXED_COUNT" and modifier.count < 2
        return not single and not modifier.offset_u and not modifier.offset_v
    if modifier.type == "SOLIDIFY":
        other = modifier.material_offset != 0 and len(obj.material_slots) > 1
        rim_only = modifier.solidify_mode == "EXTRUDE" and modifier.use_rim and modifier.use_rim_only
        return not other and not rim_only
    return modifier.type in ("SCREW", "WIREFRAME")


def fits(mesh, name=NAME):
    """True if texels of the UV map `name` stand for nearly all of the surface. Faces without area in the
    map, and faces that overlap others there, leave surface without texels."""
    still = Matrix.Identity(4)
    vertices, triangles = mesh_arrays.vertices(mesh, still, 1.0), mesh_arrays.triangles(mesh, still)
    uvs = mesh_arrays.corner_uvs(mesh.uv_layers[name])
    if not np.isfinite(uvs).all():
        return False
    first, second, third = (vertices[triangles[:, corner]] for corner in range(3))
    whole = 0.5 * float(np.linalg.norm(np.cross(second - first, third - first), axis=1).sum())
    if not 0.0 < whole < np.inf:
        return True  # nothing to unwrap: the interior refuses such a mesh
    dust = native.part("dust")
    corners = uvs[mesh_arrays.loops(mesh, still)]
    points, _ = dust.texel_points(dust.Mesh(vertices, triangles), corners, SIZE)
    return float(points.areas.sum()) >= LEAST_SHARE * whole


def _projected(mesh):
    """UV coordinates of all face corners, flat."""
    data = bpy.data
    scene, copy = data.scenes.new("lamina unwrap"), mesh.copy()
    obj = data.objects.new("lamina unwrap", copy)
    try:
        while copy.uv_layers:
            copy.uv_layers.remove(copy.uv_layers[0])
        copy.uv_layers.new(name=NAME)
        scene.collection.objects.link(obj)
        layer = scene.view_layers[0]
        layer.objects.active = obj
        obj.select_set(True, view_layer=layer)
        _unwrap(scene, layer, obj)
        found = np.empty(2 * len(copy.loops), np.float32)
        copy.uv_layers[0].uv.foreach_get("vector", found)
        return found
    finally:
        data.objects.remove(obj)
        data.meshes.remove(copy)
        data.scenes.remove(scene)


def _unwrap(scene, layer, obj):
    here = {
        "scene": scene,
        "view_layer": layer,
        "active_object": obj,
        "object": obj,
        "selected_objects": [obj],
    }
    # Without a window, Blender does not find the edited object by itself.
    edited = {"edit_object": obj, "objects_in_mode": [obj], "objects_in_mode_unique_data": [obj]}
    with bpy.context.temp_override(**here):
        bpy.ops.object.mode_set(mode="EDIT")
    try:
        with bpy.context.temp_override(**here, **edited):
            bpy.ops.mesh.reveal()
            bpy.ops.mesh.select_all(action="SELECT")
            bpy.ops.uv.smart_project(angle_limit=ANGLE, island_margin=MARGIN, correct_aspect=False)
    finally:
        with bpy.context.temp_override(**here):
            bpy.ops.object.mode_set(mode="OBJECT")
