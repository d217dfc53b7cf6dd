# SPDX-License-Identifier: GPL-3.0-or-later
"""Energy: conservative stacks lose nothing, others lose the absorption of their media, and values are plausible."""

import math

import numpy as np
import pytest
from scipy.special import expn

import lamina
from lamina import HenyeyGreenstein, Isotropic, Lambert, Medium, Rayleigh, Stack

MU = np.concatenate([np.linspace(0.05, 0.12, 57), np.linspace(0.12, 1.0, 45)])
THICKNESSES = [1e-4, 0.01, 1.0, 30.0, 1e6, math.inf]


def conserves(stack, tolerance=1e-6):
    solved = lamina.solve(stack)
    for side in ("top", "bottom") if stack.base is None else ("top",):
        for mu0 in (MU, "diffuse"):
            total = solved.reflectance(mu0, side) + solved.transmittance(mu0, side)
            assert np.abs(total - 1.0).max() < tolerance, f"{side}: {np.abs(total - 1.0).max():.2g}"
            assert solved.absorption(mu0, side) == pytest.approx(0.0, abs=tolerance)


@pytest.mark.parametrize("tau", THICKNESSES)
@pytest.mark.parametrize(
    "phase", [Isotropic(), Rayleigh(), *map(HenyeyGreenstein, (-0.9, -0.5, 0.5, 0.75, 0.9))], ids=repr)
def test_conservative_slabs(phase, tau):
    conserves(Stack([Medium(albedo=1.0, tau=tau, phase=phase)]))


@pytest.mark.parametrize("g, tau", [(0.95, 1.0), (-0.96, 10.0)])
def test_conservative_slabs_with_a_sharp_peak(g, tau):
    conserves(Stack([Medium(albedo=1.0, tau=tau, phase=HenyeyGreenstein(g))]))


@pytest.mark.parametrize("stack", [
    Stack([Medium(albedo=1.0, tau=0.3, phase=HenyeyGreenstein(0.75)), Medium(albedo=1.0, tau=2.0)]),
    Stack([Medium(albedo=1.0, tau=1e6, phase=Rayleigh()), Medium(albedo=1.0, tau=1e-3), Medium(albedo=1.0, tau=5.0)]),
    Stack([Medium(albedo=1.0, tau=1.0, phase=HenyeyGreenstein(-0.4))], base=Lambert(1.0)),
    Stack([Medium(albedo=1.0, tau=1e6)], base=Lambert(1.0)),
    Stack([Medium(albedo=1.0, tau=0.5)], base=lamina.HalfSpace(1.0, HenyeyGreenstein(0.8))),
    Stack(base=Lambert(1.0)),
], ids=["two layers", "three layers", "Lambert 1", "thick on Lambert 1", "on a half-space", "bare Lambert 1"])
def test_conservative_stacks(stack):
    conserves(stack)


@pytest.mark.parametrize("tau", [1e-6, 1e-4, 1e-2, 1.0, 10.0])
def test_pure_absorption_is_beers_law(tau):
    solved = lamina.solve(Stack([Medium(albedo=0.0, tau=tau, phase=HenyeyGreenstein(0.9))]))
    assert np.all(solved.reflectance(MU) == 0.0)
    diffuse, direct = solved.transmittance(MU, parts=True)
    assert np.all(diffuse == 0.0)
    assert direct[:, 0] == pytest.approx(np.exp(-tau / MU), rel=1e-12)
    assert solved.transmittance("diffuse")[0] == pytest.approx(2.0 * expn(3, tau), abs=4e-7)
    assert np.all(solved.brdf(MU, 0.5, 1.0) == 0.0) and np.all(solved.btdf(MU, 0.5, 1.0) == 0.0)


@pytest.mark.parametrize("phase", [Isotropic(), Rayleigh(), HenyeyGreenstein(-0.8), HenyeyGreenstein(0.85)], ids=repr)
@pytest.mark.parametrize("tau", [1e-5, 0.02, 1.0, 20.0, 1e6, math.inf])
def test_values_are_finite_and_not_negative(phase, tau):
    mu = np.array([1e-3, 0.01, 0.05, 0.3, 0.7, 0.999, 1.0])
    solved = lamina.solve(Stack([Medium(albedo=[0.3, 0.9, 1.0], tau=tau, phase=phase)]))
    for path in ("reflect", "transmit"):
        values = solved.grid(path, mu, mu, np.linspace(0.0, math.pi, 9))
        assert np.all(np.isfinite(values)) and values.min() >= 0.0
    for flux in (solved.reflectance(mu), *solved.transmittance(mu, parts=True)):
        assert np.all(np.isfinite(flux)) and flux.min() >= 0.0 and flux.max() <= 1.0 + 1e-6


@pytest.mark.parametrize("stack", [
    Stack([Medium(albedo=0.9, tau=2.0, phase=HenyeyGreenstein(0.75))]),
    Stack([Medium(albedo=0.99, tau=0.1), Medium(albedo=0.7, tau=1.0, phase=HenyeyGreenstein(-0.5))], base=Lambert(0.6)),
], ids=["slab", "layers on Lambert"])
def test_pointwise_values_add_up_to_the_fluxes(stack):
    """The BRDF integrated over the hemisphere, by our own quadrature, graded towards grazing."""
    x, w = np.polynomial.legendre.leggauss(96)
    mu, weight = (0.5 * (x + 1.0)) ** 2, 0.5 * (x + 1.0) * w
    dphi = (np.arange(256) + 0.5) * math.pi / 256
    mu0 = np.array([0.1, 0.5, 1.0])
    solved = lamina.solve(stack)
    for path, flux in (("reflect", solved.reflectance(mu0)), ("transmit", solved.transmittance(mu0, parts=True)[0])):
        mean = solved.grid(path, mu, mu0, dphi)[..., 0].mean(axis=2)
        assert 2.0 * math.pi * (weight * mu) @ mean == pytest.approx(flux[:, 0], abs=2e-5)


@pytest.mark.parametrize(
    "albedo, tau", [(0.05, 1e-5), (1e-4, 0.01), (1e-5, 0.1), (1e-6, 1.0), (1e-12, 50.0), (1e-9, 1e-9)])
def test_faint_scattering_is_single_scattering(albedo, tau):
    """Chandrasekhar's closed form; the rest is a share of albedo times tau."""
    mu_o, mu_i = 0.4, 0.7
    solved = lamina.solve(Stack([Medium(albedo=albedo, tau=tau)]))
    path = 1.0 / mu_o + 1.0 / mu_i
    expected = albedo / (4.0 * math.pi) * -math.expm1(-tau * path) / (mu_o + mu_i)
    assert solved.brdf(mu_o, mu_i, 1.0)[0] == pytest.approx(expected, rel=1e-9 + albedo * min(20.0 * tau, 2.0))


def test_more_absorption_means_less_light():
    albedos = np.linspace(0.0, 1.0, 21)
    solved = lamina.solve(Stack([Medium(albedo=list(albedos), tau=3.0, phase=HenyeyGreenstein(0.6))]))
    for mu0 in (0.1, 1.0, "diffuse"):
        assert np.all(np.diff(solved.reflectance(mu0)) > 0.0)
        assert np.all(np.diff(solved.transmittance(mu0)) > 0.0)
