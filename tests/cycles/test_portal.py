# SPDX-License-Identifier: GPL-3.0-or-later
"""The portal in Cycles: exact on a plane, and on a sphere nearer to a volume than Cycles' own random walk."""

import math

import lateral_material
import lit_edge
import lit_sphere
import numpy as np
import portal_rays
import pytest
from half_space_photons import flights
from z_limit import z_limit

import lamina
from lamina import HenyeyGreenstein, Interface, Isotropic, Medium, Stack, lobes

# Root mean square over the mean, and the energy's error. Measured: .027, .047, .115 and -.001, -.009, -.026; below a
# boundary .022, .050, .107 and .006, .004, -.022; with g .8 .032, .050, .004 and .020, -.028, .000, at 576 samples.
REACHED = {("portal_sphere", "0.03"): (0.032, 0.01), ("portal_sphere", "0.1"): (0.052, 0.02),
           ("portal_sphere", "0.3"): (0.12, 0.04),
           ("portal_sphere_boundary", "0.03"): (0.03, 0.012), ("portal_sphere_boundary", "0.1"): (0.055, 0.02),
           ("portal_sphere_boundary", "0.3"): (0.115, 0.035),
           ("portal_sphere_forward", "0.03"): (0.038, 0.03), ("portal_sphere_forward", "0.1"): (0.055, 0.04),
           ("portal_sphere_forward", "0.3"): (0.03, 0.03)}
# With four scatterings in the volume instead of the one for isotropic media: .017, .030, .052, .001, .013 and .025.
WITH_FOUR = {"0.03": (0.022, 0.01), "0.1": (0.036, 0.02), "0.3": (0.06, 0.035)}


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


@pytest.mark.parametrize("name", STACKS)
def test_plane(addon, name):
    """White sky, and light that has travelled into a shadow. The scene has the bounces that the add-on sets."""
    stack, limit = STACKS[name], z_limit(18)
    material = lateral_material.make(addon, stack, "PORTAL")
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
    *((name, path, 0) for name, path in lit_sphere.BLOCKS), *(("portal_sphere", path, 4) for path in WITH_FOUR)])
def test_sphere(addon, name, path, scatterings):
    """Against references that this repository keeps: renders of Cycles' volume, and walks."""
    material = lateral_material.make(addon, lit_sphere.stack(name, path), "PORTAL", scatterings)

    def prepare(scene):
        addon.baking.volume_bounces.provide(scene, material)

    samples = 144 if name == "portal_sphere_forward" else 48
    first, second = (lit_sphere.blocks(material, samples, seed, prepare) for seed in (1, 2))
    truth = lit_sphere.BLOCKS[name, path]
    rms, energy = WITH_FOUR[path] if scatterings else REACHED[name, path]
    # The noise of two renders is independent: the mean of their product is free of it, but for its standard error.
    error = 0.5 * np.mean((first - second) ** 2) / math.sqrt(truth.size)
    assert np.mean((first - truth) * (second - truth)) < (rms * truth.mean()) ** 2 + z_limit(12) * error
    assert 0.5 * (first + second).mean() == pytest.approx(truth.mean(), rel=energy)
