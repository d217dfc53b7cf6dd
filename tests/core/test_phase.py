# SPDX-License-Identifier: GPL-3.0-or-later
"""Phase functions and their Legendre moments, tested by layers so thin that light scatters only once."""

import math

import numpy as np
import pytest
from core_stacks import medium

from lamina import _core

POOL = _core.ThreadPool(1)
THIN = 1e-9  # multiple scattering is neglected below 1e-6
KINDS = [("isotropic", 0.0), ("rayleigh", 0.0), *(("hg", g) for g in (-0.99, -0.7, -0.2, 0.0, 0.3, 0.75, 0.9, 0.99))]


def closed_form(kind, g, cosine):
    """Mean 1 over the sphere."""
    if kind == "rayleigh":
        return 0.75 * (1.0 + cosine**2)
    return (1.0 - g * g) / (1.0 + g * g - 2.0 * g * cosine) ** 1.5


def seen(kind, g, mu_o, mu_i, dphi):
    """(cosine of the scattering angle, phase function) for light turned back and passing on."""
    albedo = 0.7
    solution = _core.solve_at(_core.Stack([medium(albedo, THIN, kind, g)]), 16, 1e-3, POOL)
    sines = np.sqrt(np.outer(1 - mu_o**2, 1 - mu_i**2))[..., None] * np.cos(dphi)
    product = np.outer(mu_o, mu_i)[..., None]
    for path, turn in ((_core.Path.reflect, -1.0), (_core.Path.transmit, 1.0)):
        value = solution.grid(_core.Side.top, path, mu_o, mu_i, dphi, POOL)
        # BRDF = BTDF = albedo p tau / (4 pi mu_o mu_i) in the limit.
        yield sines + turn * product, value * (4.0 * math.pi * product / (albedo * THIN))


@pytest.mark.parametrize("kind, g", KINDS)
class TestPhase:
    MU = np.array([0.3, 0.55, 0.8, 1.0])
    DPHI = np.linspace(0.0, math.pi, 25)

    def test_closed_form(self, kind, g):
        for cosine, phase in seen(kind, g, self.MU, self.MU, self.DPHI):
            assert phase == pytest.approx(closed_form(kind, g, cosine), rel=1e-7)

    def test_reverse_path(self, kind, g):
        for _, phase in seen(kind, g, self.MU, self.MU, self.DPHI):
            assert phase == pytest.approx(phase.swapaxes(0, 1), rel=1e-12)

    def test_normalised_and_mean_cosine(self, kind, g):
        """From normal incidence all outgoing directions are seen; Gauss over both hemispheres."""
        x, w = np.polynomial.legendre.leggauss(400)
        # A substitution gathers nodes at the poles, where peaks are.
        lowest = 1e-4
        s = 0.5 * (1.0 - x)
        mu, weight = 1.0 - (1.0 - lowest) * s**3, (1.0 - lowest) * 1.5 * s**2 * w
        total = mean = 0.0
        for cosine, phase in seen(kind, g, mu, np.array([1.0]), np.array([0.0])):
            total += 0.5 * float(weight @ phase[:, 0, 0])
            mean += 0.5 * float(weight @ (phase[:, 0, 0] * cosine[:, 0, 0]))
        missing = lowest * closed_form(kind, g, 0.0)
        assert total == pytest.approx(1.0 - missing, abs=1e-6)
        assert mean == pytest.approx(g, abs=1e-6)


@pytest.mark.parametrize("kind, g", [("isotropic", 0.0), ("rayleigh", 0.0), ("hg", -0.4), ("hg", 0.3), ("hg", 0.5)])
def test_moments_add_up_to_the_phase_function(kind, g):
    """In a layer split in two, all light except single scattering is solved by azimuth orders, from the Legendre
    moments and the addition theorem. Single scattering between the halves, subtracted order by order, must cancel
    against its closed form, which uses neither."""
    mu, dphi, tau = np.array([0.2, 0.5, 0.9]), np.linspace(0.0, math.pi, 7), 2e-5
    whole = _core.solve_at(_core.Stack([medium(1.0, tau, kind, g)]), 48, 1e-12, POOL)
    halves = _core.solve_at(_core.Stack([medium(1.0, tau / 2, kind, g)] * 2), 48, 1e-12, POOL)
    for path in (_core.Path.reflect, _core.Path.transmit):
        values = [s.grid(_core.Side.top, path, mu, mu, dphi, POOL) for s in (halves, whole)]
        assert values[0] == pytest.approx(values[1], rel=5e-6)


def test_unknown_kind_is_refused():
    with pytest.raises(ValueError, match=r"phase.kind = 'mie'"):
        _core.Medium(0.5, 1.0, "mie")
