# SPDX-License-Identifier: GPL-3.0-or-later
"""Lobes that move with the view, on the virtual goniophotometer: rough metals under lacquer and dust, flakes, and lobes
about the viewer."""

import math
from dataclasses import replace

import baked_samples
import bpy
import numpy as np
import pytest
from baked_samples import FURNACE_ERROR, INTERPOLATION, MIXTURE_RMS

import lamina
from lamina import Conductor, HenyeyGreenstein, Interface, Medium, Retroreflector, Stack
from lamina.closures import shaped_lobes

GOLD = {"facing": (1.0, 0.7837, 0.3427), "grazing": (1.0, 0.8899, 0.6307)}
STACKS = {
    "lacquered gold": Stack([Interface(1.5)], Conductor(alpha=0.1, **GOLD)),
    "tinted lacquer on gold": Stack([Interface(1.5), Medium(0.0, (0.05, 0.4, 0.9))], Conductor(alpha=0.2, **GOLD)),
    "tarnished gold": Stack([Medium((0.25, 0.17, 0.12), (0.25, 0.4, 0.6))], Conductor(alpha=0.12, **GOLD)),
    "flakes under a coat": Stack([Interface(1.5), lamina.metals.flakes("aluminium", 0.8, 0.15)], lamina.Lambert(0.05)),
    "road sign": Stack([Interface(1.5), Medium((0.93, 0.25, 0.2), (0.5, 0.9, 1.0))], Retroreflector(0.7, 0.08)),
    "dusty gold": Stack([Medium(0.8, 0.5, HenyeyGreenstein(0.6), varying=True)], Conductor(alpha=0.15, **GOLD)),
}
# A final bake of all thicknesses takes half a minute; the report gives the expected errors at either quality.
QUALITY = {"dusty gold": "preview"}
ROW = 20.5  # of the varying dust
# Bars for the report: mean and worst slice.
MEAN, WORST = 0.04, 0.11
FURNACE_SIGMA = 1e-3
# Blender before 5.0 samples tilted microfacets wrongly: a furnace is up to this much too bright.
BEFORE_5_0 = 0.03

VIEWS = baked_samples.gauss_views(4)
LIGHTS = baked_samples.about_the_mirror_direction(VIEWS, 3, 6, 3.0)
ABOUT_THE_VIEWER = replace(LIGHTS, dphi=math.pi - LIGHTS.dphi)


def lights_of(name):
    return ABOUT_THE_VIEWER if isinstance(STACKS[name].base, Retroreflector) else LIGHTS


@pytest.fixture(scope="module")
def samples(addon):
    found = {}
    for name, stack in STACKS.items():
        sample = baked_samples.make_sample(addon, name, stack, VIEWS, QUALITY.get(name, "final"), "moving")
        found[name] = sample if stack.varying is None else baked_samples.at_row(sample, ROW)
    yield found
    for sample in found.values():
        bpy.data.materials.remove(sample.material)


@pytest.fixture(scope="module")
def readings(samples):
    found = {}
    for lights in (LIGHTS, ABOUT_THE_VIEWER):
        lit = [sample for name, sample in samples.items() if lights_of(name) is lights]
        found |= baked_samples.under_the_sun(lit, "reflection", "top", lights)
    return found


@pytest.mark.parametrize("name", STACKS)
def test_the_table_moves_two_lobes_and_keeps_the_bars(name, samples):
    lut = samples[name].lut
    assert sum(map(shaped_lobes.is_shaped, lut.closures)) == 2
    assert lut.report["fit_error"] <= MEAN
    assert lut.report["worst_slice"]["error"] <= WORST
    assert lut.report["albedo_error"] <= 1e-6


@pytest.mark.parametrize("name", STACKS)
def test_the_fixed_closures_of_the_standard_basis_are_worse(name, samples):
    standard = lamina.bake(STACKS[name], "preview")
    assert standard.report["fit_error"] > 1.5 * samples[name].lut.report["fit_error"]


@pytest.mark.parametrize("name", STACKS)
def test_radiance_is_the_fitted_mixture(name, samples, readings):
    rms = samples[name].mixture_rms(readings[name, "reflection", "top"], "reflection", "top", lights_of(name))
    assert rms.max() <= MIXTURE_RMS, rms


def test_a_furnace_shows_the_exact_albedo(samples):
    found = baked_samples.in_the_furnace(list(samples.values()), FURNACE_SIGMA)
    for name, sample in samples.items():
        mean, error = found[name, "top"]
        allowed = (FURNACE_ERROR + INTERPOLATION if bpy.app.version >= (5, 0) else BEFORE_5_0) + 3.0 * error
        assert np.all(np.abs(mean / sample.albedo("top") - 1.0) <= allowed), (name, mean / sample.albedo("top"))


def test_both_fits_move_lobes_from_blender_5_0_on(addon):
    wanted = ("moving", "moving-accurate") if bpy.app.version >= (5, 0) else ("standard", "accurate")
    assert tuple(map(addon.base.preferences.table_basis, ("standard", "accurate"))) == wanted
    assert tuple(map(addon.base.preferences.table_basis, wanted)) == wanted
