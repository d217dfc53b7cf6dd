# SPDX-License-Identifier: GPL-3.0-or-later
"""Two Henyey-Greenstein lobes."""

import numpy as np
import pytest
from phase_battery import PhaseBattery

from lamina import _core

COSINES = np.linspace(-1.0, 1.0, 401)


class TestDoubleHenyeyGreenstein(PhaseBattery):
    cases = [
        (("double-hg", 0.5, -0.25, 0.75), 0.75 * 6.0 + 0.25 * 0.48, 0.75 * 2.0 / 9.0 + 0.25 * 20.0 / 9.0, 0.3125),
        (("double-hg", 0.9, -0.5, 0.9), 0.9 * 190.0 + 0.1 * 2.0 / 9.0, 0.9 * 0.1 / 3.61 + 0.1 * 6.0, 0.76),
        (("double-hg", 0.5, 0.0, 0.0), 1.0, 1.0, 0.0),
    ]


@pytest.mark.parametrize("weight, g", [(1.0, 0.8), (0.0, -0.4)])
def test_one_lobe_alone_is_henyey_greenstein(weight, g):
    one, other = _core.PhaseFunction("double-hg", 0.8, -0.4, weight), _core.PhaseFunction("hg", g)
    assert one.evaluate(COSINES) == pytest.approx(other.evaluate(COSINES), rel=1e-14)
    assert one.moment(np.arange(400)) == pytest.approx(other.moment(np.arange(400)), rel=1e-14)
    u = np.linspace(0.0, 1.0, 101)
    assert one.sample(u) == pytest.approx(other.sample(u), abs=1e-14)


def test_a_lobe_too_weak_to_notice_asks_for_no_nodes():
    assert _core.PhaseFunction("double-hg", 0.99, 0.5, 1e-6).peak == pytest.approx(0.5, abs=0.03)
