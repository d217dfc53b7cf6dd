# SPDX-License-Identifier: GPL-3.0-or-later
"""The reduction of noise in maps, against a run with many more walks."""

import numpy as np
import pytest
from map_meshes import slab_with_uvs

import lamina
from lamina import EndMaterial, Interior, Surface
from lamina.maps.places import places_of
from lamina.maps.smoothing import smoothed
from lamina.walks.searchlight_moments import Measured

SOLID, UVS = slab_with_uvs(20.0)  # the image shows 100 x 100 mm
SIDE = 32  # texels


def places():
    return places_of(SOLID, UVS, SIDE, None)


def stripes(width):
    """Veins across x, `width` mm wide, in voxels of 1 mm."""
    x = np.arange(200)[:, None, None] - 99.5
    veins = np.exp(-((((x + 30.0) % 25.0 - 12.5) / (0.5 * width)) ** 2)) * np.ones((1, 2, 2))
    palette = [EndMaterial((2.19, 2.62, 3.0), (0.0021, 0.0041, 0.0071)), EndMaterial((1.7, 1.9, 2.1), (0.3, 0.3, 0.28))]
    return Interior.mixed(veins, palette, (-100, -100, -20), (100, 100, 0))


@pytest.mark.parametrize("width", [3.0, 10.0])
def test_veins_stay_and_noise_goes(width):
    """Against 16 times the walks: less than half of the error, the same mean, and no more error on the veins' sides."""
    interior = stripes(width)
    points = places().points
    few, many = (lamina.walk_in_mesh(SOLID, interior, points.positions, points.normals, surface=Surface(1.5, 0.09),
                                     samples=samples, seed=seed).albedo for samples, seed in ((12, 1), (192, 2)))
    found = smoothed(places(), interior, few).value
    truth, noise = many.value, np.mean(many.stderr**2)

    def rms(values, where=slice(None)):
        return np.sqrt(np.mean((values - truth)[where] ** 2) - noise)

    assert rms(found) < 0.5 * rms(few.value)
    # The mean of both runs agrees within its error, of which the walks of a sample have nearly one number in common.
    error = np.sqrt((few.stderr**2).mean() + noise) / SIDE
    assert abs((found - truth).mean()) < 3.0 * error
    assert abs((found - few.value).mean()) < 0.01 * truth.mean()
    luminance = truth.mean(axis=1).reshape(SIDE, SIDE)
    slope = np.abs(np.gradient(luminance, axis=1)).ravel()
    steep = slope > np.quantile(slope, 0.8)
    assert rms(found, steep) < 0.7 * rms(few.value, steep)
    colour = (found - truth) - (found - truth).mean(axis=1, keepdims=True)
    before = (few.value - truth) - (few.value - truth).mean(axis=1, keepdims=True)
    assert colour.std() < before.std()


def test_details_that_the_guides_do_not_know_are_kept():
    """The edge of a shadow over a homogeneous interior."""
    uniform = Interior.uniform(EndMaterial(1.0, 0.1))
    rng = np.random.default_rng(3)
    edge = (np.arange(SIDE * SIDE) % SIDE >= SIDE // 2).astype(float)[:, None] * [1.0, 0.8, 0.6]
    noise = 0.02
    noisy = edge + noise * rng.standard_normal(edge.shape)
    found = smoothed(places(), uniform, Measured(noisy, np.full(edge.shape, noise))).value
    beside = np.abs(np.arange(SIDE * SIDE) % SIDE - SIDE // 2 + 0.5) < 1.0
    assert np.sqrt(np.mean((found - edge)[beside] ** 2)) < 2.0 * noise
    away = np.abs(np.arange(SIDE * SIDE) % SIDE - SIDE // 2 + 0.5) > 10.0
    assert np.sqrt(np.mean((found - edge)[away] ** 2)) < 0.5 * noise


def test_without_noise_nothing_changes():
    rng = np.random.default_rng(5)
    values = rng.uniform(size=(SIDE * SIDE, 2, 3))
    found = smoothed(places(), Interior.uniform(EndMaterial(1.0, 0.1)), Measured(values, np.zeros(values.shape))).value
    np.testing.assert_allclose(found, values, atol=1e-12)
