# SPDX-License-Identifier: GPL-3.0-or-later
"""Rough boundaries over the whole range of width and index: energy, accuracy, an independent walk, limits."""

import facet_walk
import numpy as np
import pytest
from z_limit import z_limit

import lamina
from lamina import Conductor, HenyeyGreenstein, Interface, Lambert, Medium, Stack

MU = np.array([0.05, 0.1, 0.3, 0.7, 1.0])
BOTH = pytest.mark.parametrize("distribution", ["ggx", "beckmann"])


def sheet(alpha, ior, distribution, albedo=1.0, tau=1.0):
    return Stack([Interface(ior, alpha, distribution), Medium(albedo=albedo, tau=tau),
                  Interface(1.0, alpha, distribution)])


@BOTH
@pytest.mark.parametrize("ior", [1.1, 2.5])
@pytest.mark.parametrize("alpha", [0.05, 0.3, 1.0])
def test_sheets_keep_all_energy(alpha, ior, distribution):
    solved = lamina.solve(sheet(alpha, ior, distribution))
    for side in ("top", "bottom"):
        assert solved.absorption(MU, side) == pytest.approx(0.0, abs=1e-5)


@BOTH
@pytest.mark.parametrize("alpha, ior", [(0.05, 1.5), (0.1, 1.1), (0.3, 2.5), (1.0, 1.5)])
def test_a_coat_is_right_within_a_thousandth(alpha, ior, distribution):
    stack = Stack([Interface(ior, alpha, distribution), Medium(albedo=0.9, tau=1.0)], Lambert(0.5))
    fine = lamina.solve(stack, nodes=56).reflectance(MU)
    assert lamina.solve(stack).reflectance(MU) == pytest.approx(fine, rel=3e-4)


@pytest.mark.parametrize("alpha, ior", [(0.1, 1.1), (0.2, 2.5)])
def test_both_fluxes_of_a_sheet(alpha, ior):
    stack = sheet(alpha, ior, "ggx", albedo=0.9)
    chosen, fine = lamina.solve(stack), lamina.solve(stack, nodes=56)
    assert chosen.reflectance(MU) == pytest.approx(fine.reflectance(MU), rel=1e-3)
    assert chosen.transmittance(MU) == pytest.approx(fine.transmittance(MU), rel=1e-3)


@pytest.mark.parametrize("coat", [0.05, 0.1])
def test_a_rough_coat_over_a_rough_metal(coat):
    stack = Stack([Interface(1.5, coat), Medium(albedo=0.8, tau=1.0)], Conductor(0.2, 3.9, 0.2))
    fine = lamina.solve(stack, nodes=48).reflectance(MU)
    assert lamina.solve(stack).reflectance(MU) == pytest.approx(fine, rel=1e-3)


@pytest.mark.parametrize("alpha, ior", [(0.05, 1.5), (0.5, 1.33), (0.2, 2.5)])
def test_an_independent_walk(alpha, ior):
    stack = Stack([Interface(ior, alpha, compensate=False),
                   Medium(albedo=0.9, tau=1.0, phase=HenyeyGreenstein(0.5))], Lambert(0.5))
    solved = lamina.solve(stack)
    for seed, mu0 in enumerate((0.1, 0.4, 0.9)):
        value, sigma = facet_walk.reflectance(mu0, ior=ior, alpha=alpha, albedo=0.9, tau=1.0, g=0.5, base=0.5,
                                              paths=200_000, seed=seed)
        assert abs(solved.reflectance(mu0)[0] - value) < z_limit(9) * sigma


@BOTH
def test_narrow_lobes_become_a_smooth_boundary(distribution):
    """The step from smooth to alpha is of the order of alpha at these cosines, and nothing is refused."""
    below = [Medium(albedo=0.8, tau=1.0, phase=HenyeyGreenstein(0.5))]
    mu = MU[2:]
    smooth = lamina.solve(Stack([Interface(1.5), *below], Lambert(0.5))).reflectance(mu)
    for alpha in (1e-3, 0.01):
        rough = lamina.solve(Stack([Interface(1.5, alpha, distribution), *below], Lambert(0.5))).reflectance(mu)
        assert rough == pytest.approx(smooth, rel=0.2 * alpha + 1e-4)


@pytest.mark.parametrize("alpha", [0.0, 0.1])
@pytest.mark.parametrize("tau", [1e-3, 1e-2])
def test_a_thin_film_between_boundaries(tau, alpha):
    """Solved without refinement, and accurate: a conservative scattering film, and an absorbing one on finer nodes."""
    stack = sheet(alpha, 1.5, "ggx", tau=tau)
    assert lamina.solve(stack).absorption(MU) == pytest.approx(0.0, abs=1e-5)
    stack = sheet(alpha, 1.5, "ggx", albedo=0.5, tau=tau)
    chosen, fine = lamina.solve(stack), lamina.solve(stack, nodes=48)
    assert chosen.reflectance(MU) == pytest.approx(fine.reflectance(MU), rel=1e-3)
    assert chosen.transmittance(MU) == pytest.approx(fine.transmittance(MU), rel=1e-3)
    assert chosen.brdf(0.7, 0.3, 2.0) == pytest.approx(fine.brdf(0.7, 0.3, 2.0), rel=1e-3)


@BOTH
@pytest.mark.parametrize("alpha", [0.05, 0.3, 1.0])
def test_a_perfect_metal_keeps_all_energy_when_compensated(alpha, distribution):
    mirror = Conductor(1e-3, 100.0, alpha, distribution)
    assert lamina.solve(Stack([], mirror)).reflectance(MU) == pytest.approx(1.0, abs=1e-4)
    coated = Stack([Interface(1.5, alpha, distribution), Medium(albedo=1.0, tau=0.5)], mirror)
    assert lamina.solve(coated).reflectance(MU) == pytest.approx(1.0, abs=1e-4)
