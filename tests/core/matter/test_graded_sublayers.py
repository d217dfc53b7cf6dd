# SPDX-License-Identifier: GPL-3.0-or-later
"""Sublayers that replace graded layers in the solver, against the differential form."""

import math

import numpy as np
import pytest

from lamina import _core

POOL = _core.ThreadPool(1)
MU = np.array([0.05, 0.2, 0.5, 0.8, 1.0])
DPHI = np.array([0.0, 1.0, 3.0])
PROFILES = {
    "albedo": [(0.0, 0.95, ("isotropic",)), (4.0, 0.2, ("isotropic",))],
    "phase": [(0.0, 0.9, ("hg", 0.6)), (2.0, 0.9, ("hg", -0.3))],
    "both": [(0.0, 0.2, ("hg", 0.5)), (3.0, 1.0, ("rayleigh",))],
    "bends": [(0.0, 0.3, ("isotropic",)), (0.6, 0.9, ("hg", 0.5)), (1.0, 0.9, ("hg", 0.5)), (2.5, 0.1, ("rayleigh",))],
    "jump": [(0.0, 0.9, ("hg", 0.4)), (0.5, 0.4, ("hg", 0.4)), (0.5, 0.95, ("isotropic",)), (1.5, 0.6, ("isotropic",))],
    "many knots": [(0.1 * k, 0.5 + 0.45 * math.cos(0.2 * k), ("hg", 0.3)) for k in range(21)],
    "thin": [(0.0, 1.0, ("hg", 0.3)), (0.02, 0.4, ("isotropic",))],
}


def truth(medium):
    return _core.scattering_ode(medium, MU, list(DPHI), POOL, nodes=32, tolerance=1e-9)


def values(solution):
    grids = [solution.grid(_core.Side.top, path, MU, MU, DPHI, POOL)
             for path in (_core.Path.reflect, _core.Path.transmit)]
    return np.array(grids)


def difference(found, exact):
    exact = np.array([exact["brdf"], exact["btdf"]])
    return np.abs(found - exact) / exact


@pytest.mark.parametrize("name", PROFILES)
def test_solver_against_the_differential_form(name):
    medium = _core.GradedMedium(PROFILES[name])
    solution = _core.solve(_core.Stack([medium]), 1e-3, POOL)
    exact = truth(medium)
    assert difference(values(solution), exact).max() < 1e-3
    fluxes = solution.fluxes(_core.Side.top, MU, POOL)
    np.testing.assert_allclose(fluxes.reflected, exact["reflectance"], rtol=5e-4)
    np.testing.assert_allclose(fluxes.transmitted, exact["transmittance"], rtol=5e-4)


@pytest.mark.parametrize("name", ["albedo", "both"])
def test_order(name):
    """With half the length of intervals the error falls to about an eighth: fourth order, reduced by the kinks of the
    radiance below the faces."""
    medium = _core.GradedMedium([(tau, albedo, ("isotropic",)) for tau, albedo, _ in PROFILES[name]])
    solved = [values(_core.solve_at(_core.Stack(_core.sublayers_of(medium, c)), 24, 1e-8, POOL, 1.0))
              for c in (1.0, 0.5, 0.25, 0.0625)]
    errors = [np.abs(one / solved[-1] - 1.0).max() for one in solved[:-1]]
    assert errors[0] > 8.0 * errors[1] > 64.0 * errors[2]


def test_better_than_means():
    """The same number of equal sublayers, each with the profile's value at its middle, has twenty times the error."""
    tau, count = 1.0, 16

    def at(places):
        layers = [_core.Medium(0.95 - 0.75 * x, tau / count, "isotropic") for x in places]
        return values(_core.solve_at(_core.Stack(layers), 32, 1e-8, POOL, 1.0))[:, 1:, 1:]

    pair = np.arange(count // 2)[:, None]
    exact = truth(_core.GradedMedium([(0.0, 0.95, ("isotropic",)), (tau, 0.2, ("isotropic",))]))
    exact = np.array([exact["brdf"], exact["btdf"]])[:, 1:, 1:]
    sixths = np.abs(at(((pair + [1 / 6, 5 / 6]) / (count // 2)).ravel()) / exact - 1.0).max()
    means = np.abs(at(((pair + [1 / 4, 3 / 4]) / (count // 2)).ravel()) / exact - 1.0).max()
    assert means > 20.0 * sixths


def test_a_constant_profile_is_one_sublayer():
    medium = _core.GradedMedium([(0.0, 0.8, ("hg", 0.5)), (0.7, 0.8, ("hg", 0.5)), (2.0, 0.8, ("hg", 0.5))])
    graded = values(_core.solve(_core.Stack([medium]), 1e-3, POOL))
    alone = values(_core.solve(_core.Stack([_core.Medium(0.8, 2.0, "hg", 0.5)]), 1e-3, POOL))
    np.testing.assert_allclose(graded, alone, rtol=2e-5)


def test_jumps_are_layers():
    medium = _core.GradedMedium([(0.0, 0.9, ("hg", 0.4)), (0.5, 0.9, ("hg", 0.4)), (0.5, 0.3, ("isotropic",)),
                                 (1.5, 0.3, ("isotropic",))])
    assert _core.count_sublayers(_core.Stack([medium]), 1e-3, POOL) == 2
    graded = values(_core.solve(_core.Stack([medium]), 1e-3, POOL))
    layers = [_core.Medium(0.9, 0.5, "hg", 0.4), _core.Medium(0.3, 1.0, "isotropic")]
    np.testing.assert_allclose(graded, values(_core.solve(_core.Stack(layers), 1e-3, POOL)), rtol=1e-5)


def test_another_thickness_stretches_the_sublayers():
    """Of a layer that is the second of three, between others."""
    top, bottom = _core.Medium(0.5, 0.3, "isotropic"), _core.Medium(0.9, 1.0, "hg", 0.3)
    knots = PROFILES["both"]
    full = _core.solve(_core.Stack([top, _core.GradedMedium(knots), bottom]), 1e-3, POOL)
    half = _core.GradedMedium([(0.5 * tau, albedo, phase) for tau, albedo, phase in knots])
    own = _core.solve(_core.Stack([top, half, bottom]), 1e-3, POOL)
    np.testing.assert_allclose(values(full.with_thickness(1, 1.5, POOL)), values(own), rtol=5e-4)
    thicker = _core.solve(_core.Stack([top, half, _core.Medium(0.9, 0.4, "hg", 0.3)]), 1e-3, POOL)
    np.testing.assert_allclose(values(own.with_thickness(2, 0.4, POOL)), values(thicker), rtol=5e-4)


@pytest.mark.parametrize("depths", [[0.0], [0.0, 0.0, 1.0], [0.0, 2.0, 1.0], [0.5, 1.0], [0.0, 1.0, 1.0]])
def test_knots_that_do_not_ascend(depths):
    with pytest.raises(ValueError, match="knots: "):
        _core.GradedMedium([(depth, 0.5, ("isotropic",)) for depth in depths])
