# SPDX-License-Identifier: GPL-3.0-or-later
"""The solver's own choice of directions against a finer one: .1 % pointwise for cosines >= .05."""

import math

import numpy as np
import pytest
from core_stacks import stack, thinnest

from lamina import _core

POOL = _core.ThreadPool(0)
# Grazing cosines that are no nodes, and the normal.
MU = np.array([0.05, 0.0525, 0.056, 0.07, 0.1, 0.2, 0.5, 0.71, 0.99, 1.0])
DPHI = np.append(np.linspace(0.0, math.pi, 13), [0.03, 0.1])
PROMISE = 1e-3


def worst_error(media, finer, lambert=None, azimuth=1e-7):
    given = stack(media, lambert)
    chosen, fine = _core.solve(given, PROMISE, POOL), _core.solve_at(given, finer, azimuth, POOL, thinnest(media))
    worst = 0.0
    for path in (_core.Path.reflect, _core.Path.transmit):
        value, truth = (s.grid(_core.Side.top, path, MU, MU, DPHI, POOL) for s in (chosen, fine))
        seen = truth > 1e-30
        worst = max(worst, float(np.abs(value[seen] / truth[seen] - 1.0).max(initial=0.0)))
    return worst


@pytest.mark.parametrize("tau", [1e-4, 1e-3, 1e-2, 0.1, 1.0, 50.0])
@pytest.mark.parametrize("kind, g", [("isotropic", 0.0), ("rayleigh", 0.0), *(("hg", g) for g in
                                     (-0.7, -0.4, 0.4, 0.75, 0.8))])
def test_promise(tau, kind, g):
    assert worst_error([(1.0, tau, kind, g)], 72) < PROMISE


@pytest.mark.parametrize("tau", [1e-4, 1e-2, 1.0, 50.0])
@pytest.mark.parametrize("g", [-0.9, 0.9])
def test_promise_with_a_peak(tau, g):
    assert worst_error([(0.9, tau, "hg", g)], 104) < PROMISE


@pytest.mark.parametrize("media", [
    [(0.9, 0.01, "hg", 0.75), (0.8, 1.0, "isotropic")],
    [(1.0, 1.0, "hg", 0.6), (0.5, 0.001, "rayleigh"), (0.99, 10.0, "hg", -0.4)],
], ids=["thin over thick", "three layers"])
@pytest.mark.parametrize("lambert", [None, 0.7])
def test_promise_of_stacks(media, lambert):
    assert worst_error(media, 80, lambert) < PROMISE


@pytest.mark.parametrize("g, finer", [(0.95, 160), (0.96, 184)])
def test_a_sharp_peak(g, finer):
    assert worst_error([(0.9, 1.0, "hg", g)], finer, azimuth=3e-5) < PROMISE


@pytest.mark.parametrize("g", [0.97, 0.99, -0.99])
@pytest.mark.parametrize("tau", [1e-4, 0.01, 1.0, 20.0, math.inf])
def test_a_peak_that_no_nodes_hold_is_refused(tau, g):
    with pytest.raises(RuntimeError, match=r"cannot be resolved: the peak .* its moment 320 is"):
        _core.solve(stack([(0.9, tau, "hg", g)]), PROMISE, POOL)
