# SPDX-License-Identifier: GPL-3.0-or-later
"""Draine's phase function."""

import numpy as np
import pytest
from phase_battery import PhaseBattery

from lamina import _core

COSINES = np.linspace(-1.0, 1.0, 401)


def mean_cosine(g, alpha):
    """Draine (2003), equation 9."""
    return g * (1.0 + alpha * (3.0 + 2.0 * g * g) / 5.0) / (1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0)


def ends(g, alpha):
    """4 pi p straight on and straight back."""
    both = (1.0 - g * g) * (1.0 + alpha) / (1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0)
    return both / (1.0 - g) ** 3, both / (1.0 + g) ** 3


class TestDraine(PhaseBattery):
    cases = [(("draine", g, alpha), *ends(g, alpha), mean_cosine(g, alpha))
             for g, alpha in [(0.0, 0.5), (0.3, 1.0), (-0.6, 0.4), (0.8, 20.0), (0.9, 1.0), (0.98, 0.2)]]


@pytest.mark.parametrize("alpha, other, g", [(0.0, ("hg", 0.7), 0.7), (1.0, ("cornette-shanks", 0.7), 0.7),
                                             (1.0, ("cornette-shanks", -0.2), -0.2), (1.0, ("rayleigh",), 0.0)])
def test_its_special_cases(alpha, other, g):
    one, other = _core.PhaseFunction("draine", g, alpha), _core.PhaseFunction(*other)
    assert one.evaluate(COSINES) == pytest.approx(other.evaluate(COSINES), rel=1e-13)
    assert one.moment(np.arange(400)) == pytest.approx(other.moment(np.arange(400)), rel=1e-13, abs=1e-16)
    u = np.linspace(0.0, 1.0, 101)
    assert one.sample(u) == pytest.approx(other.sample(u), abs=1e-13)


@pytest.mark.parametrize("g", [-0.9, -1e-7, 0.0, 1e-4, 0.4, 0.99])
def test_the_inversion_is_exact(g):
    phase = _core.PhaseFunction("draine", g, 1.5)
    u = np.linspace(0.0, 1.0, 41)
    x, w = np.polynomial.legendre.leggauss(400)
    for share, cosine in zip(u, phase.sample(u), strict=True):
        # In t = sqrt(1 + g^2 - 2 g cos), the substitution under which a narrow peak is smooth.
        t0, t1 = 1.0 + g, np.sqrt(1.0 + g * g - 2.0 * g * cosine)
        t = 0.5 * (t0 + t1) + 0.5 * (t1 - t0) * x
        if abs(g) < 1e-3:
            points = -1.0 + 0.5 * (cosine + 1.0) * (1.0 + x)
            found = 0.5 * (cosine + 1.0) * (w @ phase.pdf(points))
        else:
            found = 0.5 * (t0 - t1) * (w @ (phase.pdf((1.0 + g * g - t * t) / (2.0 * g)) * t / g))
        # The effect of the last digit of a cosine at the peak.
        rounding = 2e-16 * max(phase.evaluate(1.0), phase.evaluate(-1.0))
        assert found == pytest.approx(share, abs=rounding + 1e-12)
