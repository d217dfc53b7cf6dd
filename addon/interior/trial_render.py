# SPDX-License-Identifier: GPL-3.0-or-later
"""A small render of one object, at known places of its surface."""

import math
from contextlib import contextmanager
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix, Vector
from mathutils.bvhtree import BVHTree

from ..base import linking
from . import float_render, lamps, seen

SIDE = 64  # pixels along each side of the render
SAMPLES = 16  # of each of two renders
NARROW = 0.01  # width of the pixel filter, the least that Cycles has
BOUNCES = ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces", "volume_bounces",
           "transparent_max_bounces")
ANGLE = 2.0 * math.atan(0.25)  # of the camera's view, radians
ABOVE = Vector((1.0, -1.0, 0.7))  # direction to the camera in a scene without one


@dataclass(frozen=True)
class Places:
    """What the camera sees of an object. `pixels`, (n,): indices into the rows of the render. `positions` in
    mm, `normals` and `directions` to the camera, (n, 3): in the object's own axes."""

    pixels: np.ndarray
    positions: np.ndarray
    normals: np.ndarray
    directions: np.ndarray


def camera_of(scene, body):
    """(world matrix of a camera that looks at the whole body from where the scene's camera is)."""
    vertices = body.arrays.vertices / body.frame.unit
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    centre = Vector(body.frame.axes @ (0.5 * (low + high)) + body.frame.origin)
    radius = 0.5 * float(np.linalg.norm(high - low))
    towards = ABOVE if scene.camera is None else scene.camera.matrix_world.translation - centre
    if scene.camera is not None and scene.camera.data.type == "ORTHO":
        towards = scene.camera.matrix_world.to_3x3() @ Vector((0.0, 0.0, 1.0))
    towards = (towards if towards.length > 0.0 else ABOVE).normalized()
    eye = centre + radius / math.sin(0.5 * ANGLE) * towards
    return Matrix.Translation(eye) @ towards.to_track_quat("Z", "Y").to_matrix().to_4x4()


def places(body, occluders, camera):
    """The Places at the centres of the pixels, of faces with the material that no other object hides."""
    frame = body.frame
    hiding = occluders and BVHTree.FromPolygons(occluders.vertices.tolist(), occluders.triangles.tolist())
    tree = BVHTree.FromPolygons(body.arrays.vertices.tolist(), body.arrays.triangles.tolist())
    eye = Vector(frame.place(camera.translation))
    axes = np.array([frame.towards(column) for column in np.array(camera.to_3x3()).T]).T
    across = (np.arange(SIDE) + 0.5) / SIDE * 2.0 - 1.0
    slope, found = math.tan(0.5 * ANGLE), []
    for number, (row, column) in enumerate(np.ndindex(SIDE, SIDE)):
        ray = axes @ (across[column] * slope, across[row] * slope, -1.0)
        ray /= np.linalg.norm(ray)
        place, normal, face, distance = tree.ray_cast(eye, Vector(ray))
        if place is None or not body.own[face] or np.dot(normal, ray) >= 0.0:
            continue
        if not hiding or hiding.ray_cast(eye, Vector(ray), distance)[0] is None:
            found.append((number, *place, *normal, *-ray))
    found = np.array(found).reshape(-1, 10)
    return Places(found[:, 0].astype(int), found[:, 1:4], found[:, 4:7], found[:, 7:])


def pictures(context, obj, camera, materials, bounces):
    """Two renders of the object with different noise, (2, SIDE * SIDE, 3): under the scene's lamps and world
    and among the other objects, without reflections of lamps and of the world. `materials`: {material of the
    object: the one to show}. `bounces`: {setting of Cycles: least number}. Main thread only. All temporary
    data are removed. Raises RefusedError."""
    with _stage(context, obj, camera, materials) as temporary:
        float_render.prepare(temporary, SIDE, SIDE)
        cycles = temporary.cycles
        # A box filter has a width of one pixel in any case.
        cycles.samples, cycles.pixel_filter_type, cycles.filter_width = SAMPLES, "BLACKMAN_HARRIS", NARROW
        for name in BOUNCES:
            setattr(cycles, name, max(getattr(context.scene.cycles, name), bounces.get(name, 0)))
        found = []
        for seed in (1, 2):
            cycles.seed = seed
            found.append(float_render.picture(temporary)[..., :3].reshape(-1, 3))
    return np.array(found)


@contextmanager
def _stage(context, obj, camera, materials):
    """A temporary scene. Glossy rays see nothing of it."""
    scene, made, data = context.scene, [], bpy.data
    try:
        temporary = data.scenes.new("lamina trial")
        made.append((data.scenes, temporary))
        temporary.frame_set(scene.frame_current)
        temporary.unit_settings.scale_length = scene.unit_settings.scale_length
        shown = obj.copy()
        made.append((data.objects, shown))
        shown.hide_render = shown.visible_glossy = False
        temporary.collection.objects.link(shown)
        for slot in shown.material_slots:
            if materials.get(slot.material, slot.material) != slot.material:
                slot.link, slot.material = "OBJECT", materials[slot.material]
        copies = {obj: shown}
        for one in dict.fromkeys(seen.objects(context.view_layer.layer_collection)):
            is_dark = one.type == "LIGHT" and not lamps.shines(one, obj)
            if one in (obj, scene.camera) or is_dark:
                continue
            copy = one.copy()
            made.append((data.objects, copy))
            copy.visible_glossy = False
            copies[one] = copy
            temporary.collection.objects.link(copy)
        for one, copy in copies.items():
            made.extend((data.collections, new) for new in linking.copied(one, copy, copies))
        if scene.world is not None:
            temporary.world = scene.world.copy()
            made.append((data.worlds, temporary.world))
            if hasattr(temporary.world, "cycles_visibility"):
                temporary.world.cycles_visibility.glossy = False
        lens = data.cameras.new("lamina trial")
        made.append((data.cameras, lens))
        lens.type, lens.sensor_fit, lens.angle = "PERSP", "HORIZONTAL", ANGLE
        distance = camera.translation.length + max(obj.dimensions)
        lens.clip_start, lens.clip_end = 1e-5 * distance, 100.0 * distance
        eye = data.objects.new("lamina trial", lens)
        made.append((data.objects, eye))
        eye.matrix_world = camera
        temporary.collection.objects.link(eye)
        temporary.camera = eye
        yield temporary
    finally:
        for collection, item in reversed(made):
            collection.remove(item)
