# SPDX-License-Identifier: GPL-3.0-or-later
"""Values published by others, and exact results of the theory for isotropic scattering."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import lamina

# The extrapolation length of Milne's problem (Hopf 1934).
HOPF = 0.7104460896
MU = np.array([0.1, 0.3, 0.5, 0.7, 0.9, 1.0])


def slab(albedo, tau, phase=None):
    return lamina.solve(lamina.Stack([lamina.Medium(albedo=albedo, tau=tau, phase=phase or lamina.Isotropic())]))


# Heaslet and Warming, Int. J. Heat Mass Transfer 8 (1965): heat flow between black plates through a grey
# medium in radiative equilibrium, which is the diffuse transmittance of a conservative isotropic slab. Printed
# to four digits; the last ones err by up to 2e-4 against any converged solver.
HEASLET_WARMING = {0.1: 0.9157, 0.2: 0.8491, 0.3: 0.7934, 0.4: 0.7458, 0.5: 0.7040, 0.6: 0.6672, 0.8: 0.6046,
                   1.0: 0.5532, 1.5: 0.4572, 2.0: 0.3900, 2.5: 0.3401, 3.0: 0.3016, 5.0: 0.2077}


@pytest.mark.parametrize("tau, flow", HEASLET_WARMING.items())
def test_heaslet_and_warming(tau, flow):
    solved = slab(1.0, tau)
    assert solved.transmittance("diffuse")[0] == pytest.approx(flow, abs=2.1e-4)
    assert 1.0 - solved.reflectance("diffuse")[0] == pytest.approx(flow, abs=2.1e-4)


# DISORT's standard test problem 2 (Rayleigh): printed diffuse fluxes for a beam of irradiance pi, made with 16
# streams: good to 4e-5 of the incident flux. (albedo, tau, flux down, flux up).
DISORT_2 = {
    "2a": (0.5, 0.2, 4.41791e-2, 5.35063e-2),
    "2b": (1.0, 0.2, 1.06123e-1, 1.25561e-1),
    "2c": (0.5, 5.0, 2.51683e-4, 6.24730e-2),
    "2d": (1.0, 5.0, 2.68008e-2, 2.25915e-1),
}


@pytest.mark.parametrize("name", DISORT_2)
def test_disort_problem_2(name):
    albedo, tau, down, up = DISORT_2[name]
    mu0 = 0.080442
    solved = slab(albedo, tau, lamina.Rayleigh())
    diffuse, direct = solved.transmittance(mu0, parts=True)
    assert solved.reflectance(mu0)[0] == pytest.approx(up / (math.pi * mu0), abs=4e-5)
    assert diffuse[0] == pytest.approx(down / (math.pi * mu0), abs=4e-5)
    assert direct[0] == pytest.approx(math.exp(-tau / mu0), rel=1e-12)


def h_function(albedo, mu):
    """Chandrasekhar's H by iterating 1/H = sqrt(1-a) + a/2 int t H(t) / (t + mu) dt."""
    x, w = np.polynomial.legendre.leggauss(80)
    t, w = (0.5 * (x + 1.0)) ** 2, w * 0.5 * (x + 1.0)
    h = np.ones_like(t)

    def right(at):
        return 1.0 / (math.sqrt(1.0 - albedo) + 0.5 * albedo * (w * t * h / (t + at[:, None])).sum(axis=1))

    for _ in range(500):
        h = 0.5 * (h + right(t))
    first_moment = float(w @ (t * h))
    return right(np.asarray(mu)), first_moment


@pytest.mark.parametrize("albedo", [0.01, 0.3, 0.8, 0.95, 0.99, 0.9999, 1.0])
class TestHalfSpace:
    """Chandrasekhar, Radiative Transfer (1950), chapter 5."""

    def test_brdf(self, albedo):
        h, _ = h_function(albedo, MU)
        brdf = lamina.solve(lamina.Stack(base=lamina.HalfSpace(albedo))).brdf(MU[:, None], MU, 2.0)[..., 0]
        assert brdf == pytest.approx(albedo * np.outer(h, h) / (4.0 * math.pi * np.add.outer(MU, MU)), rel=2e-5)

    def test_fluxes(self, albedo):
        h, first_moment = h_function(albedo, MU)
        solved = lamina.solve(lamina.Stack(base=lamina.HalfSpace(albedo)))
        assert solved.reflectance(MU)[:, 0] == pytest.approx(1.0 - math.sqrt(1.0 - albedo) * h, abs=1e-5)
        # Spherical albedo: 1 - 2 sqrt(1-a) times H's first moment.
        expected = 1.0 - 2.0 * math.sqrt(1.0 - albedo) * first_moment
        assert solved.reflectance("diffuse")[0] == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize("tau", [20.0, 1e3, 1e6])
def test_thick_conservative_slabs_follow_milne(tau):
    """T = 4/3 / (tau + 2 q), T(mu) = sqrt(3)/4 H(mu) T: asymptotic, exact to exp(-tau) (van de Hulst 1980)."""
    solved = slab(1.0, tau)
    diffuse = 4.0 / 3.0 / (tau + 2.0 * HOPF)
    assert solved.transmittance("diffuse")[0] == pytest.approx(diffuse, rel=1e-6)
    h, _ = h_function(1.0, MU)
    assert solved.transmittance(MU)[:, 0] == pytest.approx(math.sqrt(3.0) / 4.0 * h * diffuse, rel=2e-5)


@pytest.mark.parametrize("albedo", [0.8, 0.9, 0.97, 0.99])
def test_diffusion_exponent(albedo):
    """Deep light falls like exp(-k tau), a/(2k) ln((1+k)/(1-k)) = 1 (Case and Zweifel 1967)."""
    root = brentq(lambda k: albedo / k * math.atanh(k) - 1.0, 1e-3, 1.0 - 1e-9)
    thick, thicker = (slab(albedo, tau).transmittance("diffuse")[0] for tau in (60.0, 62.0))
    assert -0.5 * math.log(thicker / thick) == pytest.approx(root, rel=1e-6)
