# SPDX-License-Identifier: GPL-3.0-or-later
"""One body in veined marble by each method: the truth, and the pictures that are compared with it."""

import time
from dataclasses import dataclass

import bpy
import cycles_render
import numpy as np

from . import columns, interiors, light, surfaces, veins, view

BOUNCES = 1024  # the most that Cycles allows
SUBPIXELS = ((0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75))
VOXEL = 0.2  # mm
NAMES = {
    "truth": "Cycles volume (truth)",
    "columns": "1D columns",
    "walk": "3D lit, towards the eye",
    "lit": "3D lit, all directions",
    "relightable": "3D relightable",
    "stock": "Stock Random Walk",
}


@dataclass(frozen=True)
class Effort:
    """Pixels along an edge, seeds and samples per seed of the truth, samples and walks of the others per set."""

    size: int
    seeds: int
    truth: int
    step_rate: float  # Cycles' steps through the volume
    sets: int  # of independent walks and renders
    walks: int  # per pixel
    vertex_walks: int
    samples: int  # of renders of surfaces


@dataclass(frozen=True, eq=False)
class Made:
    """Pictures (sets, size, size, 3) of each method by name, CPU seconds by name, and the region of comparison."""

    pictures: dict
    seconds: dict
    region: np.ndarray
    columns_solved: int


def make(body, pattern, effort, say):
    """Made for a body and its veins.Veins."""
    import lamina

    tree, size = body.tree(), effort.size
    region = view.region(body, tree, size)
    pictures, seconds, clock = {}, {}, _Clock()
    material = veins.volume(pattern)
    mesh = body.mesh()
    mesh.materials.append(material)
    thing = bpy.data.objects.new(body.name, mesh)
    scene = _scene(body, thing)
    interior = interiors.sampled(thing, material, body.vertices, VOXEL, veins.WHITE, veins.VEIN)
    seconds["voxels"] = clock.lap()
    _quality(scene, effort, effort.truth)
    scene.cycles.volume_step_rate = effort.step_rate
    material.cycles.volume_sampling = "DISTANCE"
    pictures["truth"], _ = cycles_render.render_seeds(scene, effort.seeds, lambda text: say(f"{body.name}: {text}"))
    seconds["truth"] = clock.lap()

    solid = lamina.Solid(body.vertices, body.triangles(), name=body.name)
    lamp = [lamina.Lamp(tuple(light.TOWARDS_SUN))]
    seen = view.seen(body, tree, size, SUBPIXELS)
    pictures["columns"], solved = _columns(body, tree, interior, size)
    seconds["columns"] = clock.lap()
    found = [lamina.light_in_mesh(solid, interior, lamp, seen.points, seen.normals, directions=tuple(body.towards_eye),
                                  samples=max(1, effort.walks // len(SUBPIXELS)), seed=k) for k in range(effort.sets)]
    pictures["walk"] = np.stack([_over(seen.hit, light.radiance(one.lamps.value[:, 0], one.sky.value), size)
                                 for one in found])
    seconds["walk"] = clock.lap()

    normals = np.array([vertex.normal for vertex in mesh.vertices])
    used = np.flatnonzero(_near_visible(body, tree, normals))
    where = (solid, interior)
    at = {"points": body.vertices[used], "normals": normals[used]}

    def baked(name, build):
        shots = []
        for k in range(effort.sets):
            mesh.materials[0] = build(k)
            _quality(scene, effort, 4 if name == "lit" else effort.samples)
            shots.append(cycles_render.render(scene, seed=1000 + k)[0])
        pictures[name] = np.stack(shots)
        seconds[name] = clock.lap()

    def lit(k):
        one = lamina.light_in_mesh(*where, lamp, **at, samples=effort.vertex_walks, seed=100 + k)
        return surfaces.lit(mesh, light.radiance(one.lamps.value[:, 0], one.sky.value), used)

    baked("lit", lit)
    baked("relightable", lambda k: surfaces.relightable(mesh, lamina.walk_in_mesh(
        *where, **at, directions=at["normals"], samples=effort.vertex_walks, seed=200 + k), used))
    baked("stock", lambda k: surfaces.stock(mesh, interior, at["points"], used))
    bpy.data.scenes.remove(scene)
    return Made(pictures, seconds, region, solved)


def _scene(body, thing):
    scene = bpy.data.scenes.new(body.name)
    scene.collection.objects.link(thing)
    view.build(scene, body)
    light.build(scene)
    return scene


def _quality(scene, effort, samples):
    cycles_render.unbiased(scene, effort.size, effort.size, samples, BOUNCES)
    scene.cycles.volume_max_steps = 65536


def _columns(body, tree, interior, size):
    """The 1D answer at the pixels' middles: one picture without noise, and the number of columns solved."""
    seen = view.seen(body, tree, size, [(0.5, 0.5)])
    eye = np.array(body.towards_eye)
    normals = np.where((seen.normals @ eye < 0.0)[:, None], -seen.normals, seen.normals)
    thickness = view.lengths(tree, seen.points, -normals)
    sun = np.array(light.TOWARDS_SUN)
    above = normals @ sun > 0.0
    ends = np.where(above[:, None], seen.points, seen.points - thickness[:, None] * normals)
    free = np.isinf(view.lengths(tree, ends, np.broadcast_to(sun, ends.shape)))
    values, solved = columns.radiance(interior, thickness, seen.points, normals, eye, free)
    return _over(seen.hit, values, size)[None], solved


def _over(hit, values, size):
    """The picture of the means over each pixel's rays; `values` (hits, 3). Rays without a hit see the sky."""
    full = np.tile(light.SKY, (len(hit), 1))
    full[hit] = values
    return full.reshape(size, size, -1, 3).mean(axis=2)


def _near_visible(body, tree, normals):
    """The vertices of faces that the eye may see: bool (n,)."""
    eye = body.towards_eye
    inside = np.abs((body.vertices - np.array(body.middle)) @ np.array(view.frame(eye))[:3, :2]).max(axis=1)
    inside = inside < 0.55 * body.width
    facing = normals @ np.array(eye) > 0.0
    seen = inside & facing
    seen[seen] = np.isinf(view.lengths(tree, body.vertices[seen] + 1e-3 * normals[seen],
                                       np.broadcast_to(np.array(eye), (np.count_nonzero(seen), 3))))
    # Interpolation reads the corners of all visible faces.
    for _ in range(2):
        seen[body.quads[seen[body.quads].any(axis=1)]] = True
    return seen & inside


class _Clock:
    def __init__(self):
        self._last = time.process_time()

    def lap(self):
        now = time.process_time()
        passed, self._last = now - self._last, now
        return passed
