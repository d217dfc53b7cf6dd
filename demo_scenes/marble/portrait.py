# SPDX-License-Identifier: GPL-3.0-or-later
"""The dragon in veined stone, lit from behind, so that its thin parts glow. In millimetres.

The light below the surface is computed at the vertices that the eye sees (`lamina.light_in_mesh`), averaged over
neighbours against noise, and shown by an Emission node under a glossy boundary. Cycles adds the reflections and the
floor, and Open Image Denoise removes the noise that is left, with albedo and normal passes.
"""

import math
from dataclasses import dataclass

import bpy
import cycles_render
import extension
import mesh_file
import node_tree
import numpy as np
from dragon import scene as dragon_scene
from mathutils import Vector
from mathutils.bvhtree import BVHTree
from scipy import sparse
from slab.light import frame, towards_sun

from . import surfaces, veins, view

LENS = 90.0
INDEX, ROUGHNESS = 1.5, 0.28  # of the polished surface; Blender's Roughness
VOXEL = 1.2  # mm
COLOUR_TIMES = 6
OUTLIER, OUTLIER_TIMES = 2.5, 4
FLOOR = (0.012, 0.013, 0.016)


@dataclass(frozen=True)
class Stone:
    """Coefficients (sigma_s, sigma_a) in 1/mm of ground and vein, the pattern, and the view of the dragon.

    Angles in degrees. `eye`: azimuth, elevation. `lamps`: azimuth, elevation, angular radius, and irradiance of each.
    `sky`: its radiance."""

    name: str
    ground: tuple
    vein: tuple
    pattern: veins.Veins
    eye: tuple
    lamps: tuple
    sky: tuple
    exposure: float


MARBLE = Stone(
    "Veined marble", veins.WHITE, ((1.2, 1.3, 1.4), (1.10, 1.05, 0.95)),
    veins.Veins(spacing=22.0, turn=(0.5, 0.9, 0.6), distortion=5.0, feature=34.0, octaves=3.0, edge=0.93),
    eye=(-58.0, 5.0), lamps=((92.0, 22.0, 3.0, (9.0, 6.6, 4.4)), (-165.0, 40.0, 9.0, (0.75, 0.85, 1.05))),
    sky=(0.03, 0.037, 0.05), exposure=1.5,
)
# Green stone: chosen coefficients. No measured ones of jade were found.
GREEN = Stone(
    "Green stone", ((1.1, 1.5, 1.3), (0.300, 0.022, 0.150)), ((2.0, 2.3, 2.2), (0.090, 0.020, 0.055)),
    veins.Veins(spacing=30.0, turn=(1.1, 0.3, 0.2), distortion=5.0, feature=30.0, octaves=3.0, edge=0.5),
    eye=(-58.0, 5.0), lamps=((92.0, 22.0, 3.0, (8.0, 7.4, 6.2)), (-165.0, 40.0, 9.0, (0.8, 0.9, 1.05))),
    sky=(0.035, 0.045, 0.05), exposure=1.6,
)
HEIGHT, ASIDE, WIDTH = 128.0, -14.0, 300.0  # mm: middle of the picture above the floor and to the right; its width


@dataclass(frozen=True)
class Effort:
    """Samples per vertex, times of averaging, pixels, samples."""

    walks: int
    averaged: int
    size: int
    samples: int


def figure():
    """The dragon as (Blender mesh in mm, triangles (m, 3))."""
    mesh = mesh_file.as_mesh("dragon", *mesh_file.read(dragon_scene.DRAGON))
    return mesh, mesh_file.triangles(mesh)


def picture(stone, made, effort):
    """(linear pixels (size, size, 3), facts as plain data) of the dragon `made` by figure()."""
    import lamina

    mesh, triangles = made
    vertices, normals = (_column(mesh, mesh.vertices, name) for name in ("co", "normal"))
    stage, eye = _stage(stone)
    thing = bpy.data.objects.new("dragon", mesh)
    stage.collection.objects.link(thing)
    used = _seen(vertices, normals, triangles, np.array(eye.location))
    interior = _interior(stone, thing, vertices)
    solid = lamina.Solid(vertices, triangles, name="dragon")
    lamps = [lamina.Lamp(tuple(_towards(one)), math.radians(one[2])) for one in stone.lamps]
    light = lamina.light_in_mesh(solid, interior, lamps, vertices[used], normals[used], samples=effort.walks)
    radiance = light.sky.value * stone.sky
    radiance += np.einsum("vlc,lc->vc", light.lamps.value, [one[3] for one in stone.lamps])
    radiance = without_noise(radiance, used, triangles, len(vertices), effort.averaged)
    mesh.materials.clear()
    mesh.materials.append(surfaces.polished(surfaces.lit(mesh, radiance, used), INDEX, ROUGHNESS))
    _quality(stage, effort)
    pixels = cycles_render.render(stage)[0]
    bpy.data.scenes.remove(stage)
    return pixels, {"vertices": len(vertices), "walked": len(used), "walks": effort.walks,
                    "collisions": light.count.collisions}


def _interior(stone, thing, vertices):
    """The lamina.Interior whose voxels sample the nodes of the stone's veins."""
    import lamina

    low, high = vertices.min(axis=0), vertices.max(axis=0)
    with cycles_render.quiet():
        share = extension.part("interior.node_texture").sample_nodes(
            thing, veins.material(stone.pattern), low, high, np.rint((high - low) / VOXEL).astype(int))[..., 0]
    ends = [lamina.EndMaterial(*stone.ground), lamina.EndMaterial(*stone.vein)]
    return lamina.Interior.mixed(np.clip(share, 0.0, 1.0), ends, low, high)


def without_noise(radiance, used, triangles, count, times):
    """`radiance` (k, 3) at the vertices `used` of `count`, averaged over neighbours: the brightness `times`, the colour
    COLOUR_TIMES as often, since the colour of light inside stone changes slowly. Before, vertices that are much
    brighter than their neighbours are dimmed. Nothing is measured from the result."""
    radiance = without_outliers(radiance, used, triangles, count)
    brightness = radiance.mean(axis=1, keepdims=True)
    both = averaged(np.hstack([radiance, brightness]), used, triangles, count, COLOUR_TIMES * times)
    colour = both[:, :3] / np.maximum(both[:, 3:], 1e-12)
    return colour * averaged(brightness, used, triangles, count, times)


def without_outliers(radiance, used, triangles, count):
    """`radiance` (k, 3) with a brightness of at most OUTLIER times the typical brightness of the neighbours: the square
    of the mean of their square roots. A very bright vertex raises this value, hence a second pass."""
    for _ in range(2):
        brightness = radiance.mean(axis=1, keepdims=True)
        typical = averaged(np.sqrt(brightness), used, triangles, count, OUTLIER_TIMES) ** 2
        radiance = radiance * np.minimum(1.0, OUTLIER * typical / np.maximum(brightness, 1e-12))
    return radiance


def averaged(values, used, triangles, count, times):
    """Values (k, n) at the vertices `used` of `count`, each replaced `times` by the mean over itself and its neighbours
    along edges that are used too."""
    place = np.full(count, -1)
    place[used] = np.arange(len(used))
    pairs = place[np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])]
    a, b = pairs[(pairs >= 0).all(axis=1)].T
    edges = sparse.coo_array((np.ones(len(a)), (a, b)), shape=(len(used), len(used))).tocsr()
    edges = ((edges + edges.T) > 0).astype(float) + sparse.eye_array(len(used))
    weight = np.asarray(edges.sum(axis=1)).reshape(-1, 1)
    for _ in range(times):
        values = edges @ values / weight
    return values


def _stage(stone):
    """(scene with lamps, sky, floor and camera; the camera's object)."""
    stage = bpy.data.scenes.new("portrait")
    for one in stone.lamps:
        lamp = bpy.data.lights.new("lamp", "SUN")
        lamp.energy, lamp.angle = max(one[3]), 2.0 * math.radians(one[2])
        lamp.color = [value / lamp.energy for value in one[3]]
        sun = bpy.data.objects.new("lamp", lamp)
        sun.matrix_world = frame(_towards(one))
        stage.collection.objects.link(sun)
    stage.world = bpy.data.worlds.new("sky")
    background = node_tree.of(stage.world).nodes["Background"]
    background.inputs["Color"].default_value = (*stone.sky, 1.0)
    camera = bpy.data.cameras.new("camera")
    camera.lens, camera.clip_start, camera.clip_end = LENS, 1.0, 1e5
    eye = bpy.data.objects.new("camera", camera)
    back = _towards(stone.eye)
    eye.matrix_world = frame(back)
    right = Vector((-back.y, back.x, 0.0)).normalized()
    eye.location = Vector((0.0, 0.0, HEIGHT)) + ASIDE * right + back * WIDTH * LENS / camera.sensor_width
    stage.collection.objects.link(eye)
    stage.camera = eye
    stage.collection.objects.link(_floor(back))
    stage.view_layers[0].update()
    return stage, eye


def _floor(back):
    """A dark plane that fills the picture behind the dragon: the eye sees no sky."""
    reach = 4e3
    mesh = bpy.data.meshes.new("floor")
    away = Vector((back.x, back.y, 0.0)).normalized()
    side = Vector((-away.y, away.x, 0.0))
    wall = -600.0 * away
    corners = [reach * away + reach * side, reach * away - reach * side, wall - reach * side, wall + reach * side,
               wall - reach * side + Vector((0.0, 0.0, reach)), wall + reach * side + Vector((0.0, 0.0, reach))]
    mesh.from_pydata(corners, [], [(0, 1, 2, 3), (3, 2, 4, 5)])
    material = bpy.data.materials.new("floor")
    shader = node_tree.of(material).nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*FLOOR, 1.0)
    shader.inputs["Roughness"].default_value = 0.35
    mesh.materials.append(material)
    return bpy.data.objects.new("floor", mesh)


def _towards(angles):
    return towards_sun(*map(math.radians, angles[:2]))


def _seen(vertices, normals, triangles, eye):
    """Indices of the vertices of all triangles that have a vertex in sight of the eye."""
    tree = BVHTree.FromPolygons(vertices.tolist(), triangles.tolist(), all_triangles=True)
    towards = eye - vertices
    towards /= np.linalg.norm(towards, axis=1)[:, None]
    seen = np.einsum("vk,vk->v", towards, normals) > 0.0
    starts = vertices[seen] + 0.05 * normals[seen]
    seen[seen] = np.isinf(view.lengths(tree, starts, towards[seen]))
    seen[triangles[seen[triangles].any(axis=1)]] = True
    return np.flatnonzero(seen)


def _quality(stage, effort):
    cycles_render.unbiased(stage, effort.size, effort.size, effort.samples, bounces=4)
    stage.cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    # Clamp to reduce noise: nothing is measured from this picture.
    stage.cycles.sample_clamp_indirect = 4.0
    cycles_render.denoised(stage)


def _column(mesh, items, name):
    values = np.empty(3 * len(items), np.float32)
    items.foreach_get(name, values)
    return values.reshape(-1, 3).astype(float)
