# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked materials on the virtual goniophotometer: six stacks of media, 5 view and 24 light directions.

One of the views lies on a column of the table, the others lie between two columns.
"""

import json
import math
from pathlib import Path

import baked_samples
import numpy as np
import pytest
from baked_samples import FURNACE_ERROR, INTERPOLATION, MIXTURE_RMS, PROMISE_FACTOR

from lamina.closures import shaped_lobes

ROOT = Path(__file__).resolve().parents[2]
STACKS = json.loads((ROOT / "tests/data/gonio_stacks.json").read_text())
NAMES = ["thin", "thick", "bright", "dark", "forward", "forward, off a row", "backward"]
ON_ROW, OFF_ROW = 24, 9.5  # rows of thickness at which the varying stack is seen

VIEWS = baked_samples.gauss_views(5)
LIGHTS = baked_samples.hemisphere(4, 6)
DENSE = baked_samples.hemisphere(64, 64)


@pytest.fixture(scope="module")
def samples(addon):
    def samples_of(name, stack):
        sample = baked_samples.make_sample(addon, name, stack, VIEWS)
        if stack.varying is None:
            return [sample]
        return [baked_samples.at_row(sample, ON_ROW), baked_samples.at_row(sample, OFF_ROW, name + ", off a row")]

    yield from baked_samples.made(STACKS, samples_of, NAMES)


@pytest.fixture(scope="module")
def readings(samples):
    found = {}
    for kind in ("reflection", "transmission"):
        for side in ("top", "bottom"):
            found |= baked_samples.under_the_sun(samples, kind, side, LIGHTS)
    return found


@pytest.fixture(params=NAMES)
def sample(request, samples):
    return samples[NAMES.index(request.param)]


def _errors(sample, readings, kind, side):
    return sample.errors(readings[sample.name, kind, side], kind, side, LIGHTS, DENSE)


def test_five_views_and_24_lights():
    assert len(VIEWS.mu) == 5 and VIEWS.mu.min() > 0.05
    on_a_column = np.abs(VIEWS.columns - VIEWS.columns.round()) < 1e-9
    assert 0 < on_a_column.sum() < 5
    assert LIGHTS.mu.size == 24
    assert LIGHTS.solid_angle.sum() == pytest.approx(2.0 * math.pi)
    assert (LIGHTS.solid_angle * LIGHTS.mu).sum() == pytest.approx(math.pi)


def test_radiance_is_the_fitted_mixture(sample, readings):
    for kind, side in sample.parts:
        rms = sample.mixture_rms(readings[sample.name, kind, side], kind, side, LIGHTS)
        assert rms.max() <= MIXTURE_RMS, (kind, side, rms)


def test_radiance_is_the_exact_function_within_the_promised_error(sample, readings):
    """The mean error over slices for 24 lights, without an allowance for the small number of lights."""
    for kind, side in sample.parts:
        raw, whole = _errors(sample, readings, kind, side)
        allowed = PROMISE_FACTOR * VIEWS.mean(sample.promised(kind, side))
        if any(map(shaped_lobes.is_shaped, sample.lut.closures)):  # shapes between two columns and two rows
            allowed = np.hypot(allowed, math.sqrt(2.0) * INTERPOLATION)
        assert VIEWS.mean(raw) <= allowed, (kind, side)
        assert VIEWS.mean(whole) <= allowed, (kind, side)


@pytest.mark.parametrize("kind", ["reflection", "transmission"])
def test_the_one_figure_of_the_report_is_kept(sample, readings, kind):
    """`fit_error`, the mean over all slices of a table: for tables of one thickness, where we see them all."""
    figure = sample.lut.report["fit_error" if kind == "reflection" else "fit_error_transmission"]
    sides = [side for part, side in sample.parts if part == kind]
    if not sides or sample.exact.stack.varying is not None:
        return
    for result in zip(*(_errors(sample, readings, kind, side) for side in sides), strict=True):
        assert np.mean([VIEWS.mean(errors) for errors in result]) <= PROMISE_FACTOR * figure


def test_every_view_and_channel_keeps_its_promise(sample, readings):
    for kind, side in sample.parts:
        _, whole = _errors(sample, readings, kind, side)
        allowed = np.hypot(PROMISE_FACTOR * sample.promised(kind, side), INTERPOLATION)
        assert np.all(whole <= allowed), (kind, side, whole / allowed)


def test_white_furnace_is_the_exact_albedo(sample, furnace):
    """R + T of a sheet under a sky on both sides, including direct light."""
    for side in ("top", "bottom") if sample.is_sheet else ("top",):
        mean, sigma = furnace[sample.name, side]
        exact = sample.albedo(side)
        assert np.all(sigma < sample.furnace_sigma * exact), "too noisy to say anything"
        allowed = baked_samples.STRAYED if sample.is_sheet else FURNACE_ERROR * exact
        assert np.all(np.abs(mean - exact) <= allowed), (side, mean / exact - 1.0)


def test_a_table_of_one_side_looks_the_same_on_back_faces(sample, readings):
    if len(sample.lut.header["sides"]) == 2:
        top, bottom = (readings[sample.name, "reflection", side] for side in ("top", "bottom"))
        assert np.abs(bottom / top - 1.0).max() > 0.05, "the two faces of this sheet differ"
    else:
        front, back = (readings[sample.name, "reflection", side] for side in ("top", "bottom"))
        assert back == pytest.approx(front, rel=1e-4)
