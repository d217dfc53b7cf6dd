# SPDX-License-Identifier: GPL-3.0-or-later
"""Oblique pencil beams: flux grows with the radius, densities are positive, and both agree with photons."""

import functools

import numpy as np
import pytest

import lamina
from lamina import HenyeyGreenstein, Interface, Medium, Stack

THIN = Medium(sigma_s=0.748, sigma_a=0.0138, thickness=0.688, phase=HenyeyGreenstein(-0.3))
BEAMS = {
    "matched": (Stack([THIN]), 0.761),
    "glass": (Stack([Interface(1.29), THIN, Interface(1.0)]), 0.761),
    "forward": (Stack([Medium(sigma_s=2.0, sigma_a=0.1, thickness=1.0, phase=HenyeyGreenstein(0.6))]), 0.5),
    "peaked": (Stack([Interface(1.4), Medium(sigma_s=3.0, sigma_a=0.1, thickness=0.7, phase=HenyeyGreenstein(0.85)),
                      Interface(1.0)]), 0.9),
    "two media": (Stack([Medium(sigma_s=1.0, sigma_a=0.1, thickness=0.5, phase=HenyeyGreenstein(0.3)),
                         Medium(sigma_s=3.0, sigma_a=0.0, thickness=0.3)]), 0.6),
}
RADII = np.geomspace(0.005, 6.0, 60)  # mm
TRANSFORM = 1e-6  # error of the transform at the smallest radii, as a share of all light
NEAR = {"peaked": 1e-3}  # largest difference from photons, as a share of all light; otherwise 6e-4


@functools.cache
def searchlight(name):
    return lamina.searchlight(*BEAMS[name])


@pytest.mark.parametrize("name", BEAMS)
def test_transmitted_flux_grows_with_the_radius(name):
    inside = searchlight(name).transmitted_inside(RADII)
    assert np.all(np.diff(inside, axis=0) >= -1e-12), np.diff(inside, axis=0).min()
    assert inside.min() >= -TRANSFORM


@pytest.mark.parametrize("name", BEAMS)
def test_transmitted_density_is_positive(name):
    assert searchlight(name).transmitted_profile(RADII).min() >= 0.0


@pytest.mark.parametrize("name", BEAMS)
def test_transmitted_flux_against_photons(name):
    """Beside the beam the differences exceed the noise of the photons: see docs/limits.md."""
    walked = lamina.estimate_searchlight(*BEAMS[name], samples=1 << 19, seed=1, r=RADII).transmitted_inside
    found = searchlight(name).transmitted_inside(RADII).reshape(np.shape(walked.value))
    assert np.all(np.abs(found - walked.value) <= NEAR.get(name, 6e-4) + 4.0 * walked.stderr)
