# SPDX-License-Identifier: GPL-3.0-or-later
"""One body in veined marble by each method: the truth, and the pictures that are compared with it."""

import time
from dataclasses import dataclass

import bpy
import cycles_render
import numpy as np

from . import columns, interiors, light, surfaces, veins, view

BOUNCES = 1024  # the most that Cycles allows
LIT_SAMPLES = 8  # of a render of emitted light, which is noisy only within a pixel
NAMES = {
    "truth": "Cycles volume (truth)",
    "columns": "1D columns",
    "lit": "3D Lit, to the camera",
    "lit_all": "3D Lit, all directions",
    "relightable": "3D Relightable",
    "stock": "Stock Random Walk",
}


@dataclass(frozen=True)
class Effort:
    """Pixels along an edge; seeds and samples per seed of the truth; the others' independent sets."""

    size: int
    seeds: int
    truth: int
    step_rate: float  # Cycles' steps through the volume
    sets: int  # of walks and renders
    walks: int  # samples per texel
    samples: int  # of renders with Subsurface Scattering


@dataclass(frozen=True, eq=False)
class Made:
    """Pictures (sets, size, size, 3) of each method by name, CPU seconds by name, and the region of comparison."""

    pictures: dict
    seconds: dict
    region: np.ndarray
    columns_solved: int


def make(body, pattern, effort, say):
    """Made for a body and its veins.Veins."""
    tree, mesh = body.tree(), body.mesh()
    region = view.region(body, tree, effort.size)
    pictures, seconds, clock = {}, {}, _Clock()
    material = veins.material(pattern)
    mesh.materials.append(material)
    thing = bpy.data.objects.new(body.name, mesh)
    scene = scene_of(body, thing)
    stone = interiors.Stone(scene, thing, veins.WHITE, veins.VEIN, body.voxels, body.texels(effort.size))
    seconds["voxels"] = clock.lap()
    pictures["columns"], solved = _columns(body, tree, stone.interior, effort.size)
    seconds["columns"] = clock.lap()

    def shown(name, output, samples, seed, direction="ALL"):
        shots = []
        for k in range(effort.sets):
            stone.show(output, direction, effort.walks, seed + k)
            shots.append(_rendered(scene, effort, samples, seed + k))
        pictures[name] = np.stack(shots)
        seconds[name] = clock.lap()
        say(f"{body.name}: {NAMES[name]}")

    shown("lit", "LIT", LIT_SAMPLES, 100, "CAMERA")
    shown("lit_all", "LIT", LIT_SAMPLES, 200)
    shown("relightable", "RELIGHTABLE", effort.samples, 300)
    mesh.materials[0] = surfaces.stock(mesh, stone.interior, body.vertices)
    pictures["stock"] = np.stack([_rendered(scene, effort, effort.samples, 400 + k) for k in range(effort.sets)])
    seconds["stock"] = clock.lap()
    show_volume(scene, mesh, pattern, effort.step_rate)
    cycles_render.unbiased(scene, effort.size, effort.size, effort.truth, BOUNCES)
    truth, _ = cycles_render.render_seeds(scene, effort.seeds, lambda text: say(f"{body.name}: volume, {text}"))
    seconds["truth"] = clock.lap()
    bpy.data.scenes.remove(scene)
    return Made({"truth": truth, **pictures}, seconds, region, solved)


def _rendered(scene, effort, samples, seed):
    cycles_render.unbiased(scene, effort.size, effort.size, samples, BOUNCES)
    return cycles_render.render(scene, seed)[0]


def show_volume(scene, mesh, pattern, step_rate):
    """Fill the mesh with the volume of its veins, and let Cycles take fine steps through the volume."""
    mesh.materials[0] = veins.volume(pattern)
    mesh.materials[0].cycles.volume_sampling = "DISTANCE"
    scene.cycles.volume_step_rate, scene.cycles.volume_max_steps = step_rate, 65536


def scene_of(body, thing):
    """A scene with the body's object, the camera and the light."""
    scene = bpy.data.scenes.new(body.name)
    scene.collection.objects.link(thing)
    view.build(scene, body)
    light.build(scene)
    return scene


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


class _Clock:
    def __init__(self):
        self._last = time.process_time()

    def lap(self):
        now = time.process_time()
        passed, self._last = now - self._last, now
        return passed
