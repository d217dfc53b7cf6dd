# SPDX-License-Identifier: GPL-3.0-or-later
"""Phase functions and their Legendre moments, tested by layers so thin that light scatters only once."""

import math
import random

import numpy as np
import pytest
from core_stacks import medium
from drawn_kinds import drawn
from phase_battery import Consistency

from lamina import _core
from lamina.kinds import phases

POOL = _core.ThreadPool(1)
THIN = 1e-9  # multiple scattering is neglected below 1e-6
CLOSED = [("isotropic", 0.0), ("rayleigh", 0.0), *(("hg", g) for g in (-0.99, -0.7, -0.2, 0.0, 0.3, 0.75, 0.9, 0.99))]


DRAWN = [drawn(cls, random.Random(seed)).in_channel(0) for cls in phases.KINDS for seed in (1, 2)]


def closed_form(kind, g, cosine):
    """Mean 1 over the sphere."""
    if kind == "rayleigh":
        return 0.75 * (1.0 + cosine**2)
    return (1.0 - g * g) / (1.0 + g * g - 2.0 * g * cosine) ** 1.5


def seen(thin, mu_o, mu_i, dphi):
    """(cosine of the scattering angle, phase function) for light turned back and passing on. `thin`: of albedo .7."""
    albedo = 0.7
    solution = _core.solve_at(_core.Stack([thin]), 16, 1e-3, POOL)
    sines = np.sqrt(np.outer(1 - mu_o**2, 1 - mu_i**2))[..., None] * np.cos(dphi)
    product = np.outer(mu_o, mu_i)[..., None]
    for path, turn in ((_core.Path.reflect, -1.0), (_core.Path.transmit, 1.0)):
        value = solution.grid(_core.Side.top, path, mu_o, mu_i, dphi, POOL)
        # BRDF = BTDF = albedo p tau / (4 pi mu_o mu_i) in the limit.
        yield sines + turn * product, value * (4.0 * math.pi * product / (albedo * THIN))


@pytest.mark.parametrize("kind, g", CLOSED)
class TestPhase:
    MU = np.array([0.3, 0.55, 0.8, 1.0])
    DPHI = np.linspace(0.0, math.pi, 25)

    def test_closed_form(self, kind, g):
        for cosine, phase in seen(medium(0.7, THIN, kind, g), self.MU, self.MU, self.DPHI):
            assert phase == pytest.approx(closed_form(kind, g, cosine), rel=1e-7)

    def test_reverse_path(self, kind, g):
        for _, phase in seen(medium(0.7, THIN, kind, g), self.MU, self.MU, self.DPHI):
            assert phase == pytest.approx(phase.swapaxes(0, 1), rel=1e-12)

    def test_normalised_and_mean_cosine(self, kind, g):
        """From normal incidence all outgoing directions are seen; Gauss over both hemispheres."""
        x, w = np.polynomial.legendre.leggauss(400)
        # A substitution gathers nodes at the poles, where peaks are.
        lowest = 1e-4
        s = 0.5 * (1.0 - x)
        mu, weight = 1.0 - (1.0 - lowest) * s**3, (1.0 - lowest) * 1.5 * s**2 * w
        total = mean = 0.0
        for cosine, phase in seen(medium(0.7, THIN, kind, g), mu, np.array([1.0]), np.array([0.0])):
            total += 0.5 * float(weight @ phase[:, 0, 0])
            mean += 0.5 * float(weight @ (phase[:, 0, 0] * cosine[:, 0, 0]))
        missing = lowest * closed_form(kind, g, 0.0)
        assert total == pytest.approx(1.0 - missing, abs=1e-6)
        assert mean == pytest.approx(g, abs=1e-6)


class TestEveryKind(Consistency):
    cases = [(phase,) for phase in DRAWN]


@pytest.mark.parametrize("phase", DRAWN, ids=str)
def test_every_kind_scatters_by_its_values(phase):
    mu, dphi = np.array([0.3, 0.8, 1.0]), np.linspace(0.0, math.pi, 9)
    function = _core.PhaseFunction(*phase)
    for cosine, found in seen(_core.Medium(0.7, THIN, *phase), mu, mu, dphi):
        assert found == pytest.approx(function.evaluate(cosine.ravel()).reshape(cosine.shape), rel=1e-7)


@pytest.mark.parametrize("phase", [*DRAWN, ("hg", -0.4), ("hg", 0.3), ("hg", 0.5)], ids=str)
def test_moments_add_up_to_the_phase_function(phase):
    """In a layer split in two, all light except single scattering is solved by azimuth orders, from the Legendre
    moments and the addition theorem. Single scattering between the halves, subtracted order by order, must cancel
    against its closed form, which uses neither."""
    mu, dphi, tau = np.array([0.2, 0.5, 0.9]), np.linspace(0.0, math.pi, 7), 2e-5
    whole = _core.solve_at(_core.Stack([_core.Medium(1.0, tau, *phase)]), 48, 1e-12, POOL)
    halves = _core.solve_at(_core.Stack([_core.Medium(1.0, tau / 2, *phase)] * 2), 48, 1e-12, POOL)
    for path in (_core.Path.reflect, _core.Path.transmit):
        values = [s.grid(_core.Side.top, path, mu, mu, dphi, POOL) for s in (halves, whole)]
        assert values[0] == pytest.approx(values[1], rel=5e-6)


def test_unknown_kind_is_refused():
    with pytest.raises(ValueError, match=r"phase.kind = 'mie'"):
        _core.Medium(0.5, 1.0, "mie")
