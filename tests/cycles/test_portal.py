# SPDX-License-Identifier: GPL-3.0-or-later
"""The portal in Cycles: exact on a plane, and on a sphere nearer to a volume than Cycles' own random walk."""

import json
import math
from pathlib import Path

import bpy
import goniophotometer
import lit_edge
import numpy as np
import portal_rays
import pytest
from half_space_photons import flights
from z_limit import z_limit

import lamina
from lamina import HenyeyGreenstein, Interface, Isotropic, Medium, Stack, lobes

DATA = Path(__file__).parents[1] / "data"
SPHERE = {(name, path): blocks for name in ("portal_sphere", "portal_sphere_boundary", "portal_sphere_forward")
          for path, blocks in json.loads((DATA / f"{name}.json").read_text())["paths"].items()}
# Root mean square over the mean, and the energy's error. Measured: .027, .047, .115 and -.001, -.009, -.026; below a
# boundary .022, .050, .099 and .006, .004, -.002; with g .8 .032, .041, .004 and .020, .018, .000, at 576 samples.
REACHED = {("portal_sphere", "0.03"): (0.032, 0.01), ("portal_sphere", "0.1"): (0.052, 0.02),
           ("portal_sphere", "0.3"): (0.12, 0.04),
           ("portal_sphere_boundary", "0.03"): (0.03, 0.012), ("portal_sphere_boundary", "0.1"): (0.055, 0.02),
           ("portal_sphere_boundary", "0.3"): (0.11, 0.03),
           ("portal_sphere_forward", "0.03"): (0.038, 0.03), ("portal_sphere_forward", "0.1"): (0.05, 0.03),
           ("portal_sphere_forward", "0.3"): (0.03, 0.03)}
# With four scatterings in the volume instead of the one for isotropic media.
WITH_FOUR = {"0.03": (0.03, 0.015), "0.1": (0.06, 0.03), "0.3": (0.1, 0.06)}


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


def portal(addon, name, stack, scatterings=0):
    material = bpy.data.materials.new(name)
    addon.editing.layer_list.add_stack(material)
    addon.editing.stack_io.assign_stack(material, stack)
    material.lamina.lateral_orders = scatterings
    addon.baking.lateral_job.make(material, quality="preview", output="PORTAL")
    return material


@pytest.mark.parametrize("name", STACKS)
def test_plane(addon, name):
    """White sky, and light that has travelled into a shadow. The scene has the bounces that the add-on sets."""
    stack, limit = STACKS[name], z_limit(18)
    material = portal(addon, name, stack)
    tables, beam = lamina.portal_tables(stack, "preview"), lamina.searchlight(stack, quality="preview")

    def prepare(scene):
        addon.baking.volume_bounces.provide(scene, material)

    light, error = lit_edge.exit_albedo(material, 1600, prepare)
    assert np.all(np.abs(light - beam.reflectance) < 0.002 * beam.reflectance + limit * error)
    assert np.all(error < 0.004 * beam.reflectance + 1e-4)
    moment, error = lit_edge.exit_moment(material, 400, 0.001 * 24.0 * float(beam.mean_distance.max()), prepare)
    wanted, of_orders = beam.reflectance * beam.mean_distance, 0.0
    if tables.first is not None:
        anywhere, of_orders = moments_of_orders(np.array([0.5, 0.9, 0.99]), tables.first) / 4.0  # of extinction 4
        wanted = wanted - anywhere
    entry = tables.entry
    toon = float(lobes.toon(entry.size, entry.smooth).evaluate(1.0, 1.0, 0.0))
    # The portal's light along the normal, over its mean, and the volume's light along the normal.
    r, weights, sine = portal_rays.drawn(tables, 1)
    far = weights * r[:, None]
    leaning = (1.0 / np.sqrt(1.0 + (tables.tilt * sine) ** 2)) @ far / far.sum(axis=0)
    wanted = 0.001 * (wanted * (entry.diffuse * leaning + math.pi * toon * entry.toon) + of_orders)
    assert np.all(np.abs(moment - wanted) < 0.005 * wanted + limit * error)


def moments_of_orders(albedo, first):
    """By photons, in mean free paths, for the first orders and a beam along the normal: (flux times distance; pi times
    the intensity along the normal, times distance)."""
    number, g = 400_000, first.medium.g
    anywhere, along = np.zeros(len(albedo)), np.zeros(len(albedo))
    after = flights(1.0, g, number, first.count, np.random.default_rng(5))
    for order, (_, distance, _, place, way) in enumerate(after):
        anywhere += albedo**order * distance.sum() / number
        if order < first.count:  # the collisions of the next order
            phase = (1.0 - g * g) / (1.0 + g * g + 2.0 * g * way[:, 2]) ** 1.5
            seen = 0.25 * phase * np.exp(-place[:, 2]) * np.hypot(place[:, 0], place[:, 1])
            along += albedo ** (order + 1) * seen.sum() / number
    return np.array([anywhere, along])


@pytest.mark.parametrize(("name", "path", "scatterings"), [
    *((name, path, 0) for name, path in SPHERE), *(("portal_sphere", path, 4) for path in WITH_FOUR)])
def test_sphere(addon, name, path, scatterings):
    """Against references that this repository keeps: renders of Cycles' volume, and walks."""
    extinction = 0.001 / float(path)  # per millimetre: the sphere's radius is a metre
    boundary = [Interface(1.4)] if name == "portal_sphere_boundary" else []
    forward = name == "portal_sphere_forward"
    phase = HenyeyGreenstein(0.8) if forward else Isotropic()
    material = portal(addon, "sphere", Stack([*boundary, deep([0.9], phase, extinction)]), scatterings)

    def prepare(scene):
        addon.baking.volume_bounces.provide(scene, material)

    first, second = (sphere_blocks(material, 144 if forward else 48, seed, prepare) for seed in (1, 2))
    truth = np.array(SPHERE[name, path])
    rms, energy = WITH_FOUR[path] if scatterings else REACHED[name, path]
    # The noise of two renders is independent: the mean of their product is free of it, but for its standard error.
    error = 0.5 * np.mean((first - second) ** 2) / math.sqrt(truth.size)
    assert np.mean((first - truth) * (second - truth)) < (rms * truth.mean()) ** 2 + z_limit(12) * error
    assert 0.5 * (first + second).mean() == pytest.approx(truth.mean(), rel=energy)


def sphere_blocks(material, samples, seed, prepare):
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
    prepare(scene)
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
