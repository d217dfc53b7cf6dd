# SPDX-License-Identifier: GPL-3.0-or-later
"""The tests that every phase function must pass, run on `lamina._core.PhaseFunction`: that its values, samples and
moments agree, and that they have known values."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from lamina import _core

MOMENTS = 401


def quadrature(knots=(), count: int = 24):
    """Composite Gauss nodes and weights on [-1, 1], narrow towards both ends, that do not cross `knots`."""
    angles = np.concatenate([np.linspace(0.0, np.pi, 181), np.geomspace(1e-5, 0.01, 25)])
    edges = np.unique(np.concatenate([np.cos(angles), knots, [-1.0, 1.0]]))
    x, w = np.polynomial.legendre.leggauss(count)
    half = 0.5 * np.diff(edges)[:, None]
    return (edges[:-1, None] + half * (1.0 + x)).ravel(), (half * w).ravel()


class Consistency:
    """`cases`: tuples that begin with the parameters."""

    cases: list = []
    knots: np.ndarray = np.array([])  # where the function is not smooth
    moment_accuracy = 1e-11

    def pytest_generate_tests(self, metafunc):
        if "case" in metafunc.fixturenames:
            metafunc.parametrize("case", self.cases, ids=[str(number) for number in range(len(self.cases))])

    def test_samples_match_the_pdf(self, case):
        phase = _core.PhaseFunction(*case[0])
        count, bins = 200_000, 60
        cosines = phase.sample(np.random.default_rng(7).random(count))
        assert cosines.min() >= -1.0 and cosines.max() <= 1.0
        # Bins of about equal probability, by the function's own integral on fine nodes.
        x, w = quadrature(self.knots)
        below = np.cumsum(w * phase.pdf(x))
        edges = np.concatenate([[-1.0], np.interp(np.arange(1, bins) / bins, below, x), [1.0]])
        gauss, weights = np.polynomial.legendre.leggauss(16)
        expected = np.empty(bins)
        for k, (low, high) in enumerate(zip(edges[:-1], edges[1:], strict=True)):
            parts = np.linspace(low, high, 17)
            half = 0.5 * np.diff(parts)[:, None]
            expected[k] = (half * weights * phase.pdf(parts[:-1, None] + half * (1.0 + gauss))).sum()
        found = np.histogram(cosines, edges)[0]
        assert expected.sum() == pytest.approx(1.0, abs=1e-6)
        assert stats.chisquare(found, expected / expected.sum() * count).pvalue > 1e-3

    def test_normalised(self, case):
        phase = _core.PhaseFunction(*case[0])
        x, w = quadrature(self.knots)
        assert np.all(phase.evaluate(x) >= 0.0)
        assert w @ phase.pdf(x) == pytest.approx(1.0, abs=1e-9)
        assert phase.moment(0) == pytest.approx(1.0, abs=1e-13)

    def test_moments_are_integrals(self, case):
        phase = _core.PhaseFunction(*case[0])
        x, w = quadrature(self.knots)
        weighted = w * phase.pdf(x)
        before, now = np.zeros_like(x), np.ones_like(x)
        found = phase.moment(np.arange(MOMENTS))
        for order in range(MOMENTS):
            assert found[order] == pytest.approx(weighted @ now, abs=self.moment_accuracy), order
            before, now = now, ((2 * order + 1) * x * now - order * before) / (order + 1)

    def test_peak_bounds_the_moments(self, case):
        phase = _core.PhaseFunction(*case[0])
        assert 0.0 <= phase.peak < 1.0
        chi = np.abs(phase.moment(np.arange(MOMENTS)))
        noticed = np.nonzero(chi > 2e-4)[0][-1]
        # Two moments need no counting: the coarsest solve resolves them.
        assert phase.peak**noticed >= 1.99e-4 or noticed <= 2

    def test_ends_of_the_sampling(self, case):
        phase = _core.PhaseFunction(*case[0])
        ends = phase.sample(np.array([0.0, 1.0 - 2.0**-53]))
        assert np.all(np.abs(ends) <= 1.0) and np.all(np.isfinite(ends))


class PhaseBattery(Consistency):
    """`cases`: (parameters, 4 pi p forward, 4 pi p backward, mean cosine), computed independently of the code."""

    value_accuracy = 1e-12

    def test_straight_on(self, case):
        assert _core.PhaseFunction(*case[0]).evaluate(1.0) == pytest.approx(case[1], rel=self.value_accuracy)

    def test_straight_back(self, case):
        back = _core.PhaseFunction(*case[0]).evaluate(-1.0)
        assert back == pytest.approx(case[2], rel=self.value_accuracy, abs=1e-13)

    def test_mean_cosine(self, case):
        phase = _core.PhaseFunction(*case[0])
        assert phase.moment(1) == pytest.approx(case[3], abs=1e-6)
        u = (np.arange(100_000) + 0.5) / 100_000
        assert phase.sample(u).mean() == pytest.approx(case[3], abs=1e-5)
