# SPDX-License-Identifier: GPL-3.0-or-later
"""Cornette and Shanks' phase function."""

import numpy as np
import pytest
from phase_battery import PhaseBattery

from lamina import _core


def end(g):
    """4 pi p forward; backward it is the value for -g."""
    return 3.0 * (1.0 - g * g) / ((2.0 + g * g) * (1.0 - g) ** 3)


class TestCornetteShanks(PhaseBattery):
    # Mean cosine: Cornette and Shanks (1992), equation 9.
    cases = [(("cornette-shanks", g), end(g), end(-g), 0.6 * g * (4.0 + g * g) / (2.0 + g * g))
             for g in (0.0, 0.3, -0.5, 0.9, 0.97)]


def test_without_a_peak_it_is_rayleigh():
    one, other = _core.PhaseFunction("cornette-shanks", 0.0), _core.PhaseFunction("rayleigh")
    cosines = np.linspace(-1.0, 1.0, 101)
    assert one.evaluate(cosines) == pytest.approx(other.evaluate(cosines), rel=1e-15)
    assert one.moment(np.arange(10)) == pytest.approx(other.moment(np.arange(10)), abs=1e-16)
