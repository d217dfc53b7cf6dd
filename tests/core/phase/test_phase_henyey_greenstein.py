# SPDX-License-Identifier: GPL-3.0-or-later
"""Henyey and Greenstein's phase function."""

import numpy as np
import pytest
from phase_battery import PhaseBattery

from lamina import _core


class TestHenyeyGreenstein(PhaseBattery):
    # (1 + g) / (1 - g)^2 straight on.
    cases = [
        (("hg", 0.0), 1.0, 1.0, 0.0),
        (("hg", 0.5), 6.0, 2.0 / 9.0, 0.5),
        (("hg", -0.25), 0.48, 20.0 / 9.0, -0.25),
        (("hg", 0.9), 190.0, 0.1 / 3.61, 0.9),
        (("hg", 0.98), 4950.0, 0.02 / 3.9204, 0.98),
    ]


@pytest.mark.parametrize("g", [-0.95, -0.3, 1e-9, 0.2, 0.7, 0.99])
def test_the_inversion_is_exact(g):
    u = np.linspace(0.0, 1.0, 1001)
    phase = _core.PhaseFunction("hg", g)
    cosine = phase.sample(u)
    # Pharr et al., Physically Based Rendering (2023), equation 11.24, turned round; it divides by g.
    share = (1.0 - g * g) / (2.0 * g) * (1.0 / np.sqrt(1.0 + g * g - 2.0 * g * cosine) - 1.0 / (1.0 + g))
    # The effect of the last digit of a cosine at the peak; the reference itself loses digits near g = 0.
    rounding = 2e-16 * phase.evaluate(np.sign(g)) if abs(g) > 1e-3 else 1e-6
    assert share == pytest.approx(u, abs=rounding + 1e-14)
