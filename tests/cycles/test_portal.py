# SPDX-License-Identifier: GPL-3.0-or-later
"""The portal in Cycles: exact on a plane, and on a sphere nearer to a volume than Cycles' own random walk."""

import json
import math
from pathlib import Path

import bpy
import goniophotometer
import lit_edge
import numpy as np
import pytest
from z_limit import z_limit

import lamina
from lamina import HenyeyGreenstein, Interface, Isotropic, Medium, Stack, lobes

DATA = Path(__file__).parents[1] / "data"
SPHERE = {(ior, path): blocks for ior, name in ((1.0, "portal_sphere"), (1.4, "portal_sphere_boundary"))
          for path, blocks in json.loads((DATA / f"{name}.json").read_text())["paths"].items()}
# Root mean square over the mean, and the energy's error. Measured: .03, .06, .15 and .012, .024, .012. Random Walk has
# .17, .27, .44. A portal with Lambert entry and single scattering by a local closure has .047, .095, .206.
# Under a boundary, measured: .026, .046, .129 and .009, .024, .06. With weights for a plane: .07, .16, .30 and .05,
# .12, .23.
REACHED = {(1.0, "0.03"): (0.04, 0.018), (1.0, "0.1"): (0.068, 0.03), (1.0, "0.3"): (0.16, 0.025),
           (1.4, "0.03"): (0.035, 0.014), (1.4, "0.1"): (0.056, 0.03), (1.4, "0.3"): (0.145, 0.07)}


def deep(albedos, phase, extinction=4.0):
    albedos = np.array(albedos)
    return Medium(sigma_s=extinction * albedos, sigma_a=extinction * (1.0 - albedos), thickness=np.inf, phase=phase)


STACKS = {
    "isotropic": Stack([deep([0.5, 0.9, 0.99], Isotropic())]),
    "forward": Stack([deep([0.5, 0.9, 0.99], HenyeyGreenstein(0.8))]),
    "layers under a boundary": Stack(
        [Interface(1.4), Medium(sigma_s=[2.0, 4.0, 6.0], sigma_a=[0.3, 0.1, 0.2], thickness=0.3,
                                phase=HenyeyGreenstein(0.5)), deep([0.95, 0.8, 0.9], HenyeyGreenstein(0.3))]),
}


ONCE = {"isotropic": 0.0, "forward": 0.8}  # mean cosines of the media whose single scattering is a volume's


def portal(addon, name, stack):
    material = bpy.data.materials.new(name)
    addon.editing.layer_list.add_stack(material)
    addon.editing.stack_io.assign_stack(material, stack)
    addon.baking.lateral_job.make(material, quality="preview", output="PORTAL")
    return material


@pytest.mark.parametrize("name", STACKS)
def test_plane(addon, name):
    """White sky, and light that has travelled into a shadow."""
    stack, limit = STACKS[name], z_limit(18)
    material = portal(addon, name, stack)
    beam = lamina.searchlight(stack, quality="preview")
    light, error = lit_edge.exit_albedo(material, 1600)
    assert np.all(np.abs(light - beam.reflectance) < 0.002 * beam.reflectance + limit * error)
    assert np.all(error < 0.004 * beam.reflectance + 1e-4)
    moment, error = lit_edge.exit_moment(material, 400, 0.001 * 24.0 * float(beam.mean_distance.max()))
    # Light that is scattered once leaves along the normal only where it entered: the sun at the zenith shows no moment.
    wanted = 0.001 * beam.reflectance * beam.mean_distance
    if name in ONCE:
        wanted = wanted - 0.001 * once_scattered_moment(np.array([0.5, 0.9, 0.99]), ONCE[name]) / 4.0
    entry = lamina.portal_tables(stack, "preview").entry
    toon = float(lobes.toon(entry.size, entry.smooth).evaluate(1.0, 1.0, 0.0))
    wanted = wanted * (entry.diffuse + math.pi * toon * entry.toon)  # light along the normal, over the mean
    assert np.all(np.abs(moment - wanted) < 0.005 * wanted + limit * error)


def once_scattered_moment(albedo, g):
    """Albedo times mean distance, in mean free paths, of once-scattered light: int exp(-z) E[exp(-z/mu) z tan]."""
    nodes, weights = np.polynomial.legendre.leggauss(200)
    mu, w = 0.5 * (nodes + 1.0), 0.5 * weights
    phase = (1.0 - g * g) / (1.0 + g * g + 2.0 * g * mu) ** 1.5
    # Depth: int z exp(-z (1 + 1 / mu)) dz = 1 / (1 + 1 / mu)^2; half of isotropic light goes upwards.
    return albedo * 0.5 * np.sum(w * phase * np.sqrt(1.0 - mu * mu) / mu / (1.0 + 1.0 / mu) ** 2)


@pytest.mark.parametrize(("ior", "path"), SPHERE)
def test_sphere(addon, ior, path):
    """Against references that this repository keeps: renders of Cycles' volume, and walks under a boundary."""
    extinction = 0.001 / float(path)  # per millimetre: the sphere's radius is a metre
    boundary = [Interface(ior)] if ior > 1.0 else []
    material = portal(addon, "sphere", Stack([*boundary, deep([0.9], Isotropic(), extinction)]))
    first, second = (sphere_blocks(material, 48, seed) for seed in (1, 2))
    truth = np.array(SPHERE[ior, path])
    rms, energy = REACHED[ior, path]
    # The noise of two renders is independent: the mean of their product is free of it.
    assert np.mean((first - truth) * (second - truth)) < (rms * truth.mean()) ** 2
    assert 0.5 * (first + second).mean() == pytest.approx(truth.mean(), rel=energy)


def sphere_blocks(material, samples, seed):
    scene = bpy.data.scenes.new("sphere")
    mesh = _sphere(material)
    scene.collection.objects.link(bpy.data.objects.new("sphere", mesh))
    camera = bpy.data.cameras.new("eye")
    camera.type, camera.ortho_scale = "ORTHO", 2.2
    scene.camera = bpy.data.objects.new("eye", camera)
    scene.collection.objects.link(scene.camera)
    scene.camera.location = (0.0, 0.0, 10.0)
    lamp = bpy.data.lights.new("sun", "SUN")
    lamp.angle, lamp.energy = 0.0, math.pi
    sun = bpy.data.objects.new("sun", lamp)
    scene.collection.objects.link(sun)
    sun.rotation_euler = (0.0, math.radians(45.0), math.radians(25.0))
    scene.world = goniophotometer._world(0.0)
    goniophotometer._settings(scene, samples, 1)
    scene.cycles.max_bounces, scene.cycles.seed = 8, seed
    scene.render.resolution_x = scene.render.resolution_y = 64
    try:
        pixels = goniophotometer._render(scene)
    finally:
        bpy.data.scenes.remove(scene)
        bpy.data.meshes.remove(mesh)
        bpy.data.cameras.remove(camera)
        bpy.data.lights.remove(lamp)
    return pixels[..., 0].reshape(16, 4, 16, 4).mean(axis=(1, 3))


def _sphere(material, turns=192, rings=96):
    """A sphere of radius 1 by angles, with the poles on the z axis."""
    up, turn = np.meshgrid(np.arange(1, rings) * np.pi / rings, np.arange(turns) * 2.0 * np.pi / turns, indexing="ij")
    corners = np.stack([np.sin(up) * np.cos(turn), np.sin(up) * np.sin(turn), np.cos(up)], axis=-1).reshape(-1, 3)
    corners = np.concatenate([corners, [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]])
    top, bottom = len(corners) - 2, len(corners) - 1
    faces = []
    for k in range(turns):
        after = (k + 1) % turns
        faces.append((top, k, after))
        faces += [(r * turns + k, (r + 1) * turns + k, (r + 1) * turns + after, r * turns + after)
                  for r in range(rings - 2)]
        faces.append((bottom, (rings - 2) * turns + after, (rings - 2) * turns + k))
    mesh = bpy.data.meshes.new("sphere")
    mesh.from_pydata(corners.tolist(), [], faces)
    mesh.materials.append(material)
    return mesh
