# SPDX-License-Identifier: GPL-3.0-or-later
"""The differential form of the scattering equation against the solver."""

import math

import numpy as np
import pytest
from core_stacks import stack

from lamina import _core

POOL = _core.ThreadPool(1)
MU = np.array([0.3, 0.5, 0.8, 1.0])
DPHI = [0.0, 1.0, 3.0]


def medium(albedo, tau, kind, g):
    return _core.GradedMedium.homogeneous(albedo, tau, kind, *([g] if kind == "hg" else []))


@pytest.mark.parametrize("albedo", [0.5, 1.0])
@pytest.mark.parametrize("tau", [0.1, 2.0, 20.0])
@pytest.mark.parametrize("kind, g", [("isotropic", 0.0), ("rayleigh", 0.0), ("hg", -0.3)])
def test_homogeneous_slabs(albedo, tau, kind, g):
    given = (albedo, tau, kind, g)
    fine = _core.solve_at(stack([given]), 64, 1e-12, POOL, tau)
    found = _core.scattering_ode(medium(*given), MU, DPHI, POOL, nodes=32, tolerance=1e-9)
    for path, name in ((_core.Path.reflect, "brdf"), (_core.Path.transmit, "btdf")):
        truth = fine.grid(_core.Side.top, path, MU, MU, np.array(DPHI), POOL)
        np.testing.assert_allclose(found[name], truth, rtol=1e-5, atol=1e-9)
    fluxes = fine.fluxes(_core.Side.top, MU, POOL)
    np.testing.assert_allclose(found["reflectance"], fluxes.reflected, rtol=5e-6)


def test_the_value_of_the_equation():
    """Isotropic, albedo .9, tau 1, mu 1, mu0 .5: S = .596302, dS/dtau = .306652."""
    step = 1e-3

    def s(tau):
        found = _core.scattering_ode(medium(0.9, tau, "isotropic", 0.0), [1.0, 0.5], [0.0], POOL, tolerance=1e-11)
        return 4.0 * math.pi * 0.5 * found["brdf"][0, 1, 0]

    assert s(1.0) == pytest.approx(0.596302, abs=6e-7)
    assert (s(1.0 + step) - s(1.0 - step)) / (2.0 * step) == pytest.approx(0.306652, abs=1e-6)


def test_convergence():
    """Errors fall with the tolerance; the method's order makes a step cost little more."""
    given = medium(1.0, 20.0, "isotropic", 0.0)
    best = _core.scattering_ode(given, MU, [0.0], POOL, tolerance=1e-11)["brdf"]
    errors = []
    for tolerance in (1e-5, 1e-7, 1e-9):
        value = _core.scattering_ode(given, MU, [0.0], POOL, tolerance=tolerance)["brdf"]
        errors.append(float(np.abs(value / best - 1.0).max()))
    assert errors[1] < 0.1 * errors[0] and errors[2] < 0.1 * errors[1] and errors[2] < 1e-6


def test_energy_of_a_conservative_profile():
    knots = [(0.0, 1.0, ("hg", 0.5)), (1.0, 1.0, ("isotropic",)), (3.0, 1.0, ("hg", -0.3))]
    found = _core.scattering_ode(_core.GradedMedium(knots), MU, [0.0], POOL)
    np.testing.assert_allclose(found["reflectance"] + found["transmittance"] + np.exp(-3.0 / MU), 1.0, atol=1e-6)


def test_a_step_profile_is_two_layers():
    """Knots close together make a step: then it is a stack, which the solver adds up."""
    thin = 1e-6
    knots = [(0.0, 0.9, ("hg", 0.3)), (1.0 - thin, 0.9, ("hg", 0.3)),
             (1.0, 0.6, ("isotropic",)), (2.0, 0.6, ("isotropic",))]
    found = _core.scattering_ode(_core.GradedMedium(knots), MU, DPHI, POOL)["brdf"]
    fine = _core.solve_at(stack([(0.9, 1.0, "hg", 0.3), (0.6, 1.0, "isotropic", 0.0)]), 64, 1e-12, POOL, 1.0)
    truth = fine.grid(_core.Side.top, _core.Path.reflect, MU, MU, np.array(DPHI), POOL)
    np.testing.assert_allclose(found, truth, rtol=2e-5)


def test_a_peak_that_the_nodes_do_not_hold():
    with pytest.raises(ValueError, match="nodes = 8: too few .* moment 16 is"):
        _core.scattering_ode(medium(0.9, 1.0, "hg", 0.9), MU, [0.0], POOL, nodes=8)
