# SPDX-License-Identifier: GPL-3.0-or-later
"""Phase functions by Legendre moments and by samples."""

import numpy as np
import pytest
from phase_battery import PhaseBattery, quadrature
from scipy.interpolate import PchipInterpolator

from lamina import _core


def hg(g, cosine):
    return (1.0 - g * g) / (1.0 + g * g - 2.0 * g * cosine) ** 1.5


def powers(g, count):
    return tuple(g ** np.arange(count))


def samples(g, degrees):
    cosines = -np.cos(np.radians(np.arange(0.0, 180.0 + 0.5 * degrees, degrees)))
    cosines[-1] = 1.0
    return tuple(cosines), tuple(5.0 * hg(g, cosines))


class TestByMoments(PhaseBattery):
    cases = [
        (("moments", (1.0,)), 1.0, 1.0, 0.0),
        (("moments", (1.0, 0.0, 0.1)), 1.5, 1.5, 0.0),
        (("moments", (1.0, 0.3)), 1.9, 0.1, 0.3),
        (("moments", powers(0.5, 60)), 6.0, 2.0 / 9.0, 0.5),
        (("moments", powers(0.9, 320)), 190.0, 0.1 / 3.61, 0.9),
    ]
    value_accuracy = 1e-9
    moment_accuracy = 1e-6  # the moments are the given ones, the table between its knots is as good as this


class TestBySamples(PhaseBattery):
    cases = [
        (("samples", (-1.0, 1.0), (3.0, 3.0)), 1.0, 1.0, 0.0),
        (("samples", (-1.0, 1.0), (0.0, 3.0)), 2.0, 0.0, 1.0 / 3.0),
        (("samples", *samples(0.5, 0.5)), 6.0, 2.0 / 9.0, 0.5),
        (("samples", *samples(0.9, 0.5)), 190.0, 0.1 / 3.61, 0.9),
        (("samples", *samples(-0.7, 0.25)), 0.3 / 2.89, 1.7 / 0.09, -0.7),
    ]
    knots = np.unique(np.concatenate([case[0][1] for case in cases]))
    value_accuracy = 2e-5


@pytest.mark.parametrize("count", [2, 20, 200, 1000])
def test_the_table_holds_the_series(count):
    rng = np.random.default_rng(count)
    # A positive function of the highest waves: the square of a random series, by quadrature.
    x, w = np.polynomial.legendre.leggauss(2 * count)
    root = np.polynomial.legendre.legval(x, rng.normal(size=(count + 1) // 2))
    chi = np.polynomial.legendre.legvander(x, count - 1).T @ (w * root**2)
    chi /= chi[0]
    phase = _core.PhaseFunction("moments", tuple(chi))
    cosines = np.cos(np.linspace(0.0, np.pi, 7919))
    series = np.polynomial.legendre.legval(cosines, (2.0 * np.arange(count) + 1.0) * chi)
    assert phase.evaluate(cosines) == pytest.approx(series, abs=2e-6 * series.max())
    assert phase.moment(np.arange(count)) == pytest.approx(chi, abs=1e-15)
    assert phase.moment(count) == 0.0


def test_samples_are_joined_by_monotone_cubics():
    rng = np.random.default_rng(3)
    cosines = np.sort(np.concatenate([[-1.0, 1.0], rng.uniform(-1.0, 1.0, 30)]))
    values = rng.uniform(0.0, 4.0, 32)
    joined = PchipInterpolator(cosines, values)
    x = np.linspace(-1.0, 1.0, 3001)
    expected = 2.0 * joined(x) / joined.integrate(-1.0, 1.0)
    phase = _core.PhaseFunction("samples", tuple(cosines), tuple(values))
    assert phase.evaluate(x) == pytest.approx(expected, abs=1e-13)


@pytest.mark.parametrize("count", [2, 5, 37, 181, 1801])
def test_moments_of_samples(count):
    rng = np.random.default_rng(count)
    cosines = -np.cos(np.linspace(0.0, np.pi, count))
    cosines[-1] = 1.0
    phase = _core.PhaseFunction("samples", tuple(cosines), tuple(rng.uniform(0.1, 1.0, count)))
    x, w = quadrature(cosines, 40)
    weighted = w * phase.pdf(x)
    for order in (0, 1, 2, 57, 399, 512):
        wave = np.polynomial.legendre.Legendre.basis(order)(x)
        assert phase.moment(order) == pytest.approx(weighted @ wave, abs=1e-12), order


@pytest.mark.parametrize("g, degrees, accuracy", [(0.75, 1.0, 1e-6), (0.9, 0.5, 3e-6), (0.9, 0.25, 2e-7)])
def test_sampled_henyey_greenstein(g, degrees, accuracy):
    phase = _core.PhaseFunction("samples", *samples(g, degrees))
    assert phase.moment(np.arange(400)) == pytest.approx(powers(g, 400), abs=accuracy)
    assert phase.peak == pytest.approx(g, abs=0.01)


def test_a_series_that_rounding_left_below_zero_is_zero_there():
    phase = _core.PhaseFunction("moments", (1.0, 1.0002 / 3.0))
    assert phase.evaluate(-1.0) == 0.0
    assert np.all(phase.evaluate(np.linspace(-1.0, 1.0, 1001)) >= 0.0)
    assert phase.sample(np.linspace(0.0, 1.0, 11)).min() >= -1.0
