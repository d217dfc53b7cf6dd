# SPDX-License-Identifier: GPL-3.0-or-later
"""Rayleigh scattering."""

import numpy as np
import pytest
from phase_battery import PhaseBattery

from lamina import _core


class TestRayleigh(PhaseBattery):
    cases = [(("rayleigh",), 1.5, 1.5, 0.0)]


def test_the_inversion_is_exact():
    u = np.linspace(0.0, 1.0, 1001)
    cosine = _core.PhaseFunction("rayleigh").sample(u)
    assert (cosine**3 + 3.0 * cosine + 4.0) / 8.0 == pytest.approx(u, abs=1e-15)
