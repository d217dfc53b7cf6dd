# SPDX-License-Identifier: GPL-3.0-or-later
"""The quadrature nodes of directions: Gauss-Legendre on (0, 1)."""

import numpy as np
import pytest

from lamina import _core

POOL = _core.ThreadPool(1)


def nodes(count):
    solution = _core.solve_at(_core.Stack([_core.Medium(0.5, 1.0, "isotropic")]), count, 1e-3, POOL)
    return solution.node_cosines, solution.node_weights


@pytest.mark.parametrize("count", [1, 2, 3, 8, 16, 31, 32, 72, 160])
class TestNodes:
    def test_against_numpy(self, count):
        x, w = np.polynomial.legendre.leggauss(count)
        mu, weight = nodes(count)
        assert mu == pytest.approx(0.5 * (x + 1.0), abs=1e-15)
        assert weight == pytest.approx(0.5 * w, abs=1e-14)

    def test_moments(self, count):
        mu, weight = nodes(count)
        k = np.arange(2 * count)
        assert weight @ mu[:, None] ** k == pytest.approx(1.0 / (k + 1.0), abs=1e-14)

    def test_first_moment_beyond_is_missed(self, count):
        """Exact up to degree 2n - 1: degree 2n is not integrated exactly, which confirms the number of nodes."""
        mu, weight = nodes(count)
        gap = abs(weight @ mu ** (2 * count) - 1.0 / (2 * count + 1))
        assert gap > 0.0 if count > 8 else gap > 1e-12


def test_checks_report_the_moments():
    solution = _core.solve_at(_core.Stack([_core.Medium(0.5, 1.0, "rayleigh")]), 32, 1e-3, POOL)
    assert 0.0 <= solution.checks.quadrature < 1e-14
    assert 0.0 <= solution.checks.phase < 1e-13
