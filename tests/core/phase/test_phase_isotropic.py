# SPDX-License-Identifier: GPL-3.0-or-later
"""Isotropic scattering."""

from phase_battery import PhaseBattery


class TestIsotropic(PhaseBattery):
    cases = [(("isotropic",), 1.0, 1.0, 0.0)]
