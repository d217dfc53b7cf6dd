# SPDX-License-Identifier: GPL-3.0-or-later
"""Mixtures of phase functions."""

import numpy as np
import pytest
from phase_battery import PhaseBattery

from lamina import _core

COSINES = np.linspace(-1.0, 1.0, 401)
FOG = ("mixture", (0.4, ("hg", 0.9)), (0.5, ("draine", 0.5, 1.0)), (0.0, ("isotropic",)),
       (0.1, ("moments", (1.0, 0.2))))
DRAINE = 0.75 * 2.0 / 1.5  # (1 - g^2) (1 + alpha) / (1 + alpha (1 + 2 g^2) / 3)


class TestMixture(PhaseBattery):
    cases = [
        (("mixture", (0.25, ("rayleigh",)), (0.75, ("hg", 0.5))), 0.375 + 4.5, 0.375 + 0.75 * 2.0 / 9.0, 0.375),
        (FOG, 76.0 + 0.5 * DRAINE * 8.0 + 0.16, 0.04 / 3.61 + 0.5 * DRAINE / 3.375 + 0.04,
         0.36 + 0.25 * (1.0 + 3.5 / 5.0) / 1.5 + 0.02),
        (("mixture", (1.0, ("isotropic",))), 1.0, 1.0, 0.0),
    ]
    value_accuracy = 1e-8  # one part is a table


def test_of_two_lobes_is_the_double_lobe():
    one = _core.PhaseFunction("mixture", (0.7, ("hg", 0.8)), (0.3, ("hg", -0.4)))
    other = _core.PhaseFunction("double-hg", 0.8, -0.4, 0.7)
    assert one.evaluate(COSINES) == pytest.approx(other.evaluate(COSINES), rel=1e-14)
    assert one.moment(np.arange(400)) == pytest.approx(other.moment(np.arange(400)), rel=1e-13)
    u = np.linspace(0.0, 1.0, 101)
    assert one.sample(u) == pytest.approx(other.sample(u), abs=1e-12)
    assert one.peak == other.peak


def test_shares_count_by_their_ratio():
    one = _core.PhaseFunction("mixture", (2.0, ("hg", 0.8)), (6.0, ("rayleigh",)))
    other = _core.PhaseFunction("mixture", (0.25, ("hg", 0.8)), (0.75, ("rayleigh",)))
    assert np.array_equal(one.evaluate(COSINES), other.evaluate(COSINES))
