# SPDX-License-Identifier: GPL-3.0-or-later
"""The 3D scattering function against photons, at five frequencies each, family-wise."""

import functools

import numpy as np
import pytest
from photon_walk_3d import Slab, at_frequency, fresnel, walk
from z_limit import z_limit

import lamina
from lamina import HenyeyGreenstein, Interface, Lambert, Medium, Stack

PHOTONS = 400_000
FREQUENCIES = (0.25, 0.7, 1.5, 3.0, 6.0)
SLABS = {
    "matched": Slab(((1.8, 0.2, 1.0, 0.75),)),
    "peaked": Slab(((5.7, 0.3, 0.8, 0.9),)),
    "two layers": Slab(((3.0, 0.3, 0.4, 0.8), (0.8, 0.2, 1.5, 0.0))),
    "glass": Slab(((1.5, 0.1, 1.0, 0.4),), ior=1.5),
    "varnish": Slab(((0.2, 0.3, 0.2, 0.0), (3.0, 0.1, 0.8, 0.6)), ior=1.4, base=0.6),
}
RADII = (0.05, 0.2, 0.6, 1.5)
LARGEST_Z = z_limit(2 * len(SLABS) * (len(FREQUENCIES) + len(RADII)))


def stack_of(slab: Slab) -> Stack:
    media = [Medium(sigma_s=s, sigma_a=a, thickness=t, phase=HenyeyGreenstein(g)) for s, a, t, g in slab.layers]
    if slab.ior != 1.0:
        media = [Interface(slab.ior), *media, *([Interface(1.0)] if slab.base is None else [])]
    return Stack(media, None if slab.base is None else Lambert(slab.base))


@functools.cache
def walked(name):
    return walk(SLABS[name], PHOTONS, seed=11)


@pytest.mark.parametrize("name", SLABS)
def test_photons_at_frequencies(name):
    slab, beam = SLABS[name], lamina.searchlight(stack_of(SLABS[name]))
    mirrored = fresnel(slab.ior, 1.0) if slab.ior != 1.0 else 0.0
    for points, values in zip(walked(name), (beam.reflected_at(FREQUENCIES) - mirrored,
                                             beam.transmitted_at(FREQUENCIES)), strict=True):
        for q, value in zip(FREQUENCIES, values, strict=True):
            mean, error = at_frequency(points, q, PHOTONS)
            assert abs(value - mean) < LARGEST_Z * error, (q, value, mean, error)


@pytest.mark.parametrize("name", SLABS)
def test_reflected_photons_by_distance(name):
    slab, beam = SLABS[name], lamina.searchlight(stack_of(SLABS[name]))
    mirrored = fresnel(slab.ior, 1.0) if slab.ior != 1.0 else 0.0
    _compare(walked(name)[0], beam.reflected_inside(RADII) - mirrored)


@pytest.mark.parametrize("name", SLABS)
def test_transmitted_photons_by_distance(name):
    beam = lamina.searchlight(stack_of(SLABS[name]))
    _compare(walked(name)[1], beam.transmitted_inside(RADII))


def _compare(points, values):
    r = np.hypot(points[:, 0], points[:, 1])
    for radius, value in zip(RADII, values, strict=True):
        share = np.count_nonzero(r <= radius) / PHOTONS
        error = np.sqrt(max(share * (1.0 - share), 1e-8) / PHOTONS)
        assert abs(value - share) < LARGEST_Z * error, (radius, value, share, error)
