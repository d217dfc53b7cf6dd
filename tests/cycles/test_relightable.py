# SPDX-License-Identifier: GPL-3.0-or-later
"""Relightable materials in Cycles: the light below the surface leaves in the right amount, at the right distance."""

import lateral_material
import lit_distance
import lit_edge
import numpy as np
import pytest
from z_limit import z_limit

import lamina
from lamina import HenyeyGreenstein, Interface, Medium, Stack

LIMIT = z_limit(54)
ALBEDO_ERROR, DISTANCE_ERROR = 0.001, 0.003  # of the promised .003 and .01, besides the noise


def deep(albedos, g, thickness=np.inf):
    albedos = np.array(albedos)
    return Medium(sigma_s=4.0 * albedos, sigma_a=4.0 * (1.0 - albedos), thickness=thickness, phase=HenyeyGreenstein(g))


STACKS = {
    "isotropic": Stack([deep([0.6, 0.9, 0.99], 0.0)]),
    "forward": Stack([deep([0.8, 0.95, 0.99], 0.75)]),
    "far forward": Stack([deep([0.9, 0.97, 0.99], 0.9)]),
    "bright": Stack([deep([0.97, 0.995, 0.999], 0.0)]),
    "slab": Stack([deep([0.8, 0.95, 0.99], 0.5, 2.5)]),
    "layers under a boundary": Stack(
        [Interface(1.4), Medium(sigma_s=[2.0, 4.0, 6.0], sigma_a=[0.3, 0.1, 0.2], thickness=0.3,
                                phase=HenyeyGreenstein(0.5)), deep([0.95, 0.8, 0.9], 0.3)]),
}


@pytest.mark.parametrize("name", STACKS)
def test_exit_albedo_and_distance(addon, name):
    stack = STACKS[name]
    material = lateral_material.make(addon, stack)
    beam = lamina.searchlight(stack, quality="preview")
    light, error = lit_edge.exit_albedo(material, 160)
    # The preview of the searchlight is itself good to 1e-4 of the incident flux.
    assert np.all(np.abs(light - beam.reflectance) < ALBEDO_ERROR * beam.reflectance + LIMIT * error)
    # A lamp without size shows no mirrored light, which leaves at the distance 0.
    leaving = beam.reflectance - beam.mirrored
    wanted = 0.001 * beam.reflectance * beam.mean_distance / leaving
    (light, error), (distance, way_error) = lit_distance.exit_albedo_and_distance(material, 256, 2.0 * wanted.max())
    assert np.all(np.abs(light - leaving) < ALBEDO_ERROR * leaving + LIMIT * error)
    assert np.all(np.abs(distance - wanted) < DISTANCE_ERROR * wanted + LIMIT * way_error)
    assert np.all(error < 0.004 * leaving) and np.all(way_error < 0.006 * wanted)
