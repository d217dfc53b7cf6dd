# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets, and dark materials, in a white furnace: the effect in Cycles of light that strays above the horizon, and of
small weights."""

import math

import baked_samples
import bpy
import goniophotometer
import numpy as np
import pytest

import lamina
from lamina import HenyeyGreenstein, Interface, Medium, Stack

COLUMNS = np.array([16.0, 34.0, 46.0])
VIEWS = baked_samples.Views(COLUMNS, np.full(3, 1 / 3))
LEAF = [Medium([0.35, 0.75, 0.22], tau=[2.4, 1.8, 4.6], phase=HenyeyGreenstein(0.1)), Interface(1.0)]
STACKS = {
    "leaf with a rough cuticle": Stack([Interface(1.38, 0.25), *LEAF]),
    "forward sheet": Stack([Medium(0.95, tau=1.0, phase=HenyeyGreenstein(0.9))]),
    "thin forward sheet": Stack([Medium(0.9, tau=0.2, phase=HenyeyGreenstein(0.85))]),
    "etched glass": Stack([Interface(1.5, 0.2), Interface(1.0)]),
    "dark": Stack([Medium(1e-3, tau=1.0)], lamina.Black()),
}
REPEATS, SAMPLES, SIGMAS = 16, 512, 4.5
# Error relative to a view's light, in addition to the report's: the closed form of Cycles' estimator neglects lobes
# that cross the horizon from above, and the interpolation error of Cycles' table of the Fresnel factor.
MODEL = 0.004


@pytest.fixture(scope="module")
def samples(addon):
    found = {name: baked_samples.make_sample(addon, name, stack, VIEWS, "preview") for name, stack in STACKS.items()}
    yield found
    for sample in found.values():
        bpy.data.materials.remove(sample.material)


@pytest.mark.parametrize("name", STACKS)
def test_a_white_sky_shows_what_the_report_says(samples, name, monkeypatch):
    monkeypatch.setattr(goniophotometer, "_READ", slice(1, 7))
    sample = samples[name]
    exact = sample.albedo("top")
    stated = (sample.lut.report["strayed_light"] or {"furnace_error": 0.0})["furnace_error"]
    for view, column in enumerate(COLUMNS):
        mu_o = math.cos(column / 63 * math.pi / 2)
        values = goniophotometer.furnace_many([sample.material] * REPEATS, mu_o, SAMPLES)
        mean, sigma = values.mean(axis=0), values.std(axis=0, ddof=1) / math.sqrt(REPEATS)
        allowed = (stated + MODEL) * exact[view] + SIGMAS * sigma
        assert np.all(np.abs(mean - exact[view]) <= allowed), (column, mean / exact[view] - 1.0)
    assert stated < 0.01
