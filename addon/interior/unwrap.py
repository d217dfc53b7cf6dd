# SPDX-License-Identifier: GPL-3.0-or-later
"""Automatic UV maps without overlaps, by Blender's Smart UV Project on a copy of the mesh."""

import bpy
import numpy as np

from ..base.messages import RefusedError

NAME = "Lamina"  # of the UV map
# Limit of the angle in radians, small enough that islands of curved handles do not fold over; margin between
# islands, relative to the image.
ANGLE, MARGIN = 0.8, 0.01


def ensure(obj):
    """Make the UV map `NAME` of a mesh object, if it is missing. The selection, the mode and other UV
    maps are not changed. Returns the name. Raises RefusedError."""
    mesh = obj.data
    if NAME in mesh.uv_layers:
        return NAME
    if not mesh.polygons:
        raise RefusedError(f"{obj.name} has no faces: an interior needs a closed mesh")
    corners = _projected(mesh)
    layer = mesh.uv_layers.new(name=NAME, do_init=False)
    if layer is None or len(corners) != 2 * len(mesh.loops):
        raise RefusedError(f"{obj.name} cannot get another UV map: remove one, or choose one of its own")
    layer.uv.foreach_set("vector", corners)
    return layer.name


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
