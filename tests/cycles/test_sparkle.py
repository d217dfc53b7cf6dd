# SPDX-License-Identifier: GPL-3.0-or-later
"""Sparkle of flakes on the virtual goniophotometer: the mean over cells is the smooth material, which no sparkle leaves
as it was; single cells flash, and fade with distance."""

from dataclasses import replace

import baked_samples
import bpy
import goniophotometer
import numpy as np
import pytest

import lamina
from lamina import Interface, Lambert, Stack

STACKS = {
    "silver": Stack([Interface(1.5), lamina.metals.flakes("aluminium", 1.5, 0.18)], Lambert(0.12)),
    "loose": Stack([lamina.metals.flakes("copper", 1.0, 0.35)], Lambert((0.3, 0.1, 0.05))),
}
VIEWS = baked_samples.Views(np.array([0.5, 14.0, 28.0]), np.full(3, 1 / 3))
OBLIQUE = baked_samples.Views(np.array([42.0, 52.0]), np.full(2, 0.5))
# Azimuths, and offsets of the light's angle from the mirror direction, in degrees: where the flakes' lobe is bright.
LIGHTS = ((0.0, -14.0), (0.3, 0.0), (0.8, 8.0))
MEAN = 0.02  # relative difference of means
COPIES, SAMPLES, PATCHES = 24, 1024, 60
SMALL, LARGE, FAR = 1e-3, 0.4, 1e7  # sizes of cells against pixels of 1 / 8, and a distance that never fades


def with_sparkle(material, sparkle, size=SMALL, distance=FAR):
    copy = material.copy()
    node = next(node for node in copy.node_tree.nodes if node.type == "GROUP")
    for name, value in (("Sparkle", sparkle), ("Flake Size", size), ("Fade Distance", distance)):
        node.inputs[name].default_value = value
    return copy


@pytest.fixture(scope="module", params=STACKS)
def baked(addon, request):
    sample = baked_samples.make_sample(addon, request.param, STACKS[request.param], VIEWS, basis="moving")
    yield sample
    bpy.data.materials.remove(sample.material)


def readings(material, light=None, views=VIEWS, samples=SAMPLES):
    """(mean, standard error) over copies of a patch, each of shape (views, 3): of all light, or under a sun."""
    found = []
    for mu in views.mu.tolist():
        if light is None:
            values = goniophotometer.furnace_many([material] * COPIES, mu, samples)
        else:
            angle = np.arccos(mu) + np.radians(light[1])
            # A light that is turned past the normal comes from the other side.
            dphi = light[0] if angle >= 0.0 else np.pi - light[0]
            values = goniophotometer.measure_many([material] * COPIES, mu, float(np.cos(angle)), dphi, samples)
        found.append((values.mean(axis=0), values.std(axis=0, ddof=1) / COPIES**0.5))
    return np.moveaxis(np.array(found), 1, 0)


@pytest.mark.skipif(bpy.app.version < (5, 0, 0), reason="earlier versions sample tilted microfacets wrongly")
@pytest.mark.parametrize("views", [VIEWS, OBLIQUE], ids=["steep", "oblique"])
def test_a_furnace_shows_the_energy_of_the_smooth_material(baked, views):
    mean, error = readings(with_sparkle(baked.material, 1.0), views=views)
    exact = replace(baked, views=views).albedo("top")
    ratio, error = mean / exact, error / exact
    assert error.max() < 0.005
    assert np.all(np.abs(ratio - 1.0) <= MEAN + 3.0 * error), ratio
    assert np.abs(ratio / ratio.mean(axis=1, keepdims=True) - 1.0).max() <= 0.2 * MEAN


@pytest.mark.parametrize("light", LIGHTS)
def test_the_mean_over_cells_is_the_smooth_lobe(baked, light):
    smooth, _ = readings(with_sparkle(baked.material, 0.0), light, samples=4)
    mean, error = readings(with_sparkle(baked.material, 1.0), light)
    ratio, error = mean / smooth, error / smooth
    assert error.max() < 0.02
    assert np.all(np.abs(ratio - 1.0) <= MEAN + 3.0 * error), ratio
    # All channels sparkle alike, so their ratios are known better than their means.
    assert np.abs(ratio / ratio.mean(axis=1, keepdims=True) - 1.0).max() <= 0.2 * MEAN


def test_no_sparkle_is_the_material_as_it_was(baked):
    lights = baked_samples.about_the_mirror_direction(VIEWS, 2, 3, 3.0)
    found = baked_samples.under_the_sun([baked], "reflection", "top", lights)
    rms = baked.mixture_rms(found[baked.name, "reflection", "top"], "reflection", "top", lights)
    assert rms.max() <= baked_samples.MIXTURE_RMS, rms


def test_cells_flash_and_fade_as_one_over_the_distance(baked):
    def flashes(distance):
        material = with_sparkle(baked.material, 1.0, LARGE, distance)
        return goniophotometer.measure_many([material] * PATCHES, 0.9, 0.9, 0.0, 64)[:, 1]

    smooth = goniophotometer.measure_many([with_sparkle(baked.material, 0.0)], 0.9, 0.9, 0.0, 4)[0, 1]
    near, faded = flashes(FAR), flashes(5.0)
    assert near.max() > 3.0 * smooth
    assert np.median(near) < 0.7 * smooth
    assert near.max() < 1.0 / 0.15**2 * smooth  # the ratio of the widths, squared
    # The camera is 10 units above the middle of the row of patches, and reads three quarters across each.
    away = np.hypot(10.0, np.arange(PATCHES) + 0.75 - 0.5 * PATCHES)
    off = faded - smooth - (near - smooth) * 5.0 / away
    # Over the two pixels read, the distance varies by .6 % to either side, and their cells may differ.
    assert np.all(np.abs(off) < 0.01 * (near + smooth) * 5.0 / away)
    assert np.median(np.abs(off) / (near + smooth)) < 1e-3
