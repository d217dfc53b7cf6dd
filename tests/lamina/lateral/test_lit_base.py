# SPDX-License-Identifier: GPL-3.0-or-later
"""The searchlight near the spot that the beam illuminates on a diffuse base, compared with the exact solution for
layers without scattering, and with photons."""

import math

import numpy as np
import pytest
from z_limit import z_limit

import lamina
from lamina import HalfSpace, HenyeyGreenstein, Interface, Lambert, Medium, Stack

R = np.array([0.1, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 4.0])


def layer_over_lambert(sigma_a, thickness, reflectance):
    return Stack([Medium(sigma_s=0.0, sigma_a=sigma_a, thickness=thickness)], Lambert(reflectance))


@pytest.mark.parametrize("quality", ["preview", "final"])
@pytest.mark.parametrize("sigma_a", [0.0, 0.3, 1.2])
def test_a_layer_that_does_not_scatter(sigma_a, quality):
    """Light from the spot at the angle t to the normal leaves at the distance thickness * tan(t), attenuated along the
    path thickness / cos(t). The base reflects the share d(sin^2 t) in this direction. No light returns to the base."""
    thickness, reflectance = 0.8, 0.7
    beam = lamina.searchlight(layer_over_lambert(sigma_a, thickness, reflectance), quality=quality)
    x, weight = np.polynomial.legendre.leggauss(200)
    expected = []
    for r in R:
        square = 0.5 * r**2 / (r**2 + thickness**2) * (x + 1.0)  # sin^2 t
        path = thickness / np.sqrt(1.0 - square)
        share = 0.5 * r**2 / (r**2 + thickness**2) * np.sum(weight * np.exp(-sigma_a * path))
        expected.append(reflectance * math.exp(-sigma_a * thickness) * share)
    np.testing.assert_allclose(beam.reflected_inside(R), expected, atol=5e-5 if quality == "final" else 3e-4)


@pytest.mark.parametrize("stack", [
    Stack([Medium(sigma_s=0.9, sigma_a=0.1, thickness=1.0)], Lambert(0.8)),
    Stack([Interface(1.4), Medium(sigma_s=0.3, sigma_a=0.05, thickness=1.0, phase=HenyeyGreenstein(0.3))],
          Lambert(0.6)),
], ids=["bright layer", "varnish"])
def test_photons(stack):
    """Fluxes in rings, compared with 5e5 photons per stack."""
    beam = lamina.searchlight(stack)
    walk = lamina.estimate_searchlight(stack, r=R, q=(8.0, 16.0, 24.0), samples=500_000, seed=5)
    scores = np.concatenate([(beam.reflected_inside(R) - walk.reflected_inside.value) / walk.reflected_inside.stderr,
                             (beam.reflected_at(walk.q) - walk.reflected_at.value) / walk.reflected_at.stderr])
    assert np.max(np.abs(scores)) < 3.6, scores


@pytest.mark.parametrize("g", [0.0, 0.5, 0.8])
@pytest.mark.parametrize("base", [Lambert(0.9), HalfSpace(sigma_s=30.0, sigma_a=1.0)], ids=["lambert", "half-space"])
def test_thin_layers(g, base):
    """Light that a base scatters near the beam, seen through a thin layer that scatters."""
    stack = Stack([Medium(sigma_s=2.0, sigma_a=0.1, thickness=0.2, phase=HenyeyGreenstein(g))], base)
    walk = lamina.estimate_searchlight(stack, q=(5.0, 20.0, 55.0), samples=300_000, seed=7)
    apart = lamina.searchlight(stack).reflected_at(walk.q) - walk.reflected_at.value
    assert np.max(np.abs(apart / walk.reflected_at.stderr)) < z_limit(18)
