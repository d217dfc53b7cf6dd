# SPDX-License-Identifier: GPL-3.0-or-later
"""The reduction of noise in maps, against a run with many more walks."""

import numpy as np
import pytest
from map_meshes import slab_with_uvs

import lamina
from lamina import EndMaterial, Interior, Surface, _core
from lamina.maps.places import Places, places_of
from lamina.maps.smoothing import smoothed
from lamina.maps.windows import windows
from lamina.settling.mesh import Points
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
    found = smoothed(places(), interior, few, is_light=True).value
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


def test_one_walk_per_point_is_smoothed_too():
    """The noise of one walk is unknown. The square of the value takes the place of the variance."""
    points = places().points
    one, many = (lamina.walk_in_mesh(SOLID, stripes(10.0), points.positions, points.normals, surface=Surface(1.5, 0.09),
                                     samples=samples, seed=seed).albedo for samples, seed in ((1, 1), (192, 2)))
    assert np.array_equal(one.stderr, one.value)
    assert np.mean(one.stderr**2) > np.mean((one.value - many.value) ** 2)
    found = smoothed(places(), stripes(10.0), one, is_light=True).value
    assert np.mean((found - many.value) ** 2) < 0.25 * np.mean((one.value - many.value) ** 2)


def test_details_that_the_guides_do_not_know_are_kept():
    """The edge of a shadow over a homogeneous interior."""
    uniform = Interior.uniform(EndMaterial(1.0, 0.1))
    rng = np.random.default_rng(3)
    edge = (np.arange(SIDE * SIDE) % SIDE >= SIDE // 2).astype(float)[:, None] * [1.0, 0.8, 0.6]
    noise = 0.02
    noisy = edge + noise * rng.standard_normal(edge.shape)
    found = smoothed(places(), uniform, Measured(noisy, np.full(edge.shape, noise)), is_light=True).value
    beside = np.abs(np.arange(SIDE * SIDE) % SIDE - SIDE // 2 + 0.5) < 1.0
    assert np.sqrt(np.mean((found - edge)[beside] ** 2)) < 2.0 * noise
    away = np.abs(np.arange(SIDE * SIDE) % SIDE - SIDE // 2 + 0.5) > 10.0
    assert np.sqrt(np.mean((found - edge)[away] ** 2)) < 0.5 * noise


def test_without_noise_nothing_changes():
    rng = np.random.default_rng(5)
    values = rng.uniform(size=(SIDE * SIDE, 2, 3))
    found = smoothed(places(), Interior.uniform(EndMaterial(1.0, 0.1)), Measured(values, np.zeros(values.shape)),
                     is_light=True).value
    np.testing.assert_allclose(found, values, atol=1e-12)


UNIFORM = Interior.uniform(EndMaterial(1.0, 0.1))
NET = 41  # vertices along an edge


def net():
    """The vertices of a flat net of triangles, 1 mm apart; the last row has no values."""
    y, x = np.divmod(np.arange(NET * NET), NET)
    corner = (NET * np.arange(NET - 1)[:, None] + np.arange(NET - 1)).ravel()
    triangles = np.concatenate([corner[:, None] + (0, 1, NET), corner[:, None] + (1, NET + 1, NET)])
    mask = y < NET - 1
    points = Points(np.column_stack([x, y, 0.0 * x])[mask].astype(float), np.tile([0.0, 0.0, 1.0], (mask.sum(), 1)))
    return Places(points, mask, triangles)


@pytest.mark.parametrize("made", [places, net])
def test_colours_of_noise_go(made):
    """A step of brightness with the noise of three independent channels: the step stays, and less than a third of the
    noise of colours is left. Without step 4 most of it is left beside the step."""
    at = made()
    rng, noise = np.random.default_rng(1), 0.1
    x = at.points.positions[:, 0]
    step = np.where(x > np.median(x), 2.0, 1.0)[:, None] * [1.0, 0.8, 0.6]
    noisy = step + noise * rng.standard_normal(step.shape)
    near = np.abs(x - np.median(x)) < 3.0 * np.diff(np.unique(x)).min()

    def left(values, where):
        colour, before = (one / one.mean(axis=1, keepdims=True) - step / step.mean(axis=1, keepdims=True)
                          for one in (values, noisy))
        return np.sqrt(np.mean(colour[where] ** 2) / np.mean(before[where] ** 2))

    found, plain = (smoothed(at, UNIFORM, Measured(noisy, np.full(step.shape, noise)), is_light=is_light).value
                    for is_light in (True, False))
    assert left(found, near | ~near) < 0.33 and left(found, near) < 0.33
    assert left(plain, near) > 0.6
    assert abs(found.mean() / noisy.mean() - 1.0) < 0.002


def test_a_channel_without_noise_stays():
    rng, noise = np.random.default_rng(1), np.array([0.0, 0.1, 0.1])
    values = np.full((SIDE * SIDE, 3), 0.8) + noise * rng.standard_normal((SIDE * SIDE, 3))
    found = smoothed(places(), UNIFORM, Measured(values, np.broadcast_to(noise, values.shape)),
                     is_light=True).value
    np.testing.assert_allclose(found[:, 0], 0.8, rtol=1e-6)


def test_a_single_bright_vertex_leaves_no_spot_and_its_light_is_kept():
    """One vertex of the net is 60 times as bright as the others, in one channel, from a single walk."""
    at = net()
    values = np.full((len(at.points.positions), 3), 0.5)
    errors = np.full(values.shape, 0.01)
    middle = NET * (NET // 2) + NET // 2
    values[middle, 1] += 30.0
    errors[middle, 1] = 30.0
    found = smoothed(at, UNIFORM, Measured(values, errors), is_light=True).value
    assert found.min() > 0.49 and found.max() < 0.56
    assert found.mean() == pytest.approx(values.mean(), rel=0.01)


def test_neighbours_along_edges():
    """Windows of vertices reach 4 edges, wide ones 12; two sheets 0.1 mm apart have nothing in common."""
    at = net()
    two = Places(Points(np.concatenate([at.points.positions, at.points.positions + [0.0, 0.0, 0.1]]),
                        np.tile(at.points.normals, (2, 1))), np.tile(at.mask, 2),
                 np.concatenate([at.triangles, at.triangles + len(at.mask)]))
    half = len(at.points.positions)
    made = windows(two, _core.ThreadPool(1))
    for window, reach in ((made.narrow(), 4), (made.wide(), 12)):
        furthest = 0.0
        for other, weight in zip(window.numbers, window.weights, strict=True):
            used = weight > 0.0
            assert np.all((other[used] < half) == (np.flatnonzero(used) < half))
            apart = np.abs(two.points.positions[other] - two.points.positions)[used]
            furthest = max(furthest, apart.max(initial=0.0))
        assert 0.75 * reach <= furthest <= 1.2 * reach  # diagonals count as edges
        assert window.mean(np.ones((2 * half, 1))) == pytest.approx(1.0, abs=1e-12)
