# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers so thin that light meets them once: between boundaries, where scattered light may be trapped, against the
limit in closed form; beside other layers, where they have no effect."""

import math

import numpy as np
import pytest

import lamina
from lamina import HenyeyGreenstein, Interface, Knot, Lambert, Medium, Stack

MU = np.array([0.05, 0.2, 0.5, 0.7, 1.0])
IOR = 1.5


def film_in_glass(mu_o, mu_i, tau, albedo):
    """BRDF and BTDF, for tau -> 0, of an isotropic film inside a sheet of smooth glass. Inside, a beam and its
    reflections pass the film with 1 / (1 - r) of the light that entered, 1 - r: Fresnel's factors cancel. Of what
    the film scatters, the share cos(critical angle) is trapped until the film scatters it again."""
    inside = [math.sqrt(1.0 - (1.0 - mu * mu) / IOR**2) for mu in (mu_o, mu_i)]
    trapped = math.sqrt(1.0 - 1.0 / IOR**2)
    return albedo * tau / (4.0 * math.pi * IOR**2 * inside[0] * inside[1] * (1.0 - albedo * trapped))


@pytest.mark.parametrize("quality", ["preview", "final"])
@pytest.mark.parametrize("albedo", [0.5, 1.0])
@pytest.mark.parametrize("tau", [1e-4, 1e-5, 1e-6, 1e-9, 1e-11])
def test_a_film_in_glass_scatters_as_its_limit(tau, albedo, quality):
    solved = lamina.solve(Stack([Interface(IOR), Medium(albedo=albedo, tau=tau), Interface(1.0)]), quality)
    for mu_o, mu_i, dphi in ((0.7, 0.5, 1.0), (0.2, 1.0, 3.0), (0.05, 0.3, 0.0)):
        expected = film_in_glass(mu_o, mu_i, tau, albedo)
        assert solved.brdf(mu_o, mu_i, dphi)[0] == pytest.approx(expected, rel=1e-3)
        assert solved.btdf(mu_o, mu_i, dphi)[0] == pytest.approx(expected, rel=1e-3)
    if albedo == 1.0:
        assert solved.absorption(MU) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("films", [
    [Medium(albedo=0.6, tau=3e-6), Medium(albedo=0.6, tau=1e-7)],
    [Medium(tau=3.1e-6, profile=[Knot(0.0, albedo=0.3), Knot(1.0, albedo=0.9)])],
    [Medium(albedo=0.6, tau=3e-6), Interface(IOR), Medium(albedo=0.6, tau=1e-7)],
], ids=["two", "graded", "apart"])
def test_several_films_act_together(films):
    solved = lamina.solve(Stack([Interface(IOR), *films, Interface(1.0)]))
    assert solved.brdf(0.7, 0.5, 1.0)[0] == pytest.approx(film_in_glass(0.7, 0.5, 3.1e-6, 0.6), rel=1e-3)


@pytest.mark.parametrize("tau", [1e-5, 1e-9])
@pytest.mark.parametrize("alpha", [0.0, 0.2])
def test_a_thin_layer_beside_a_thick_one_changes_nothing(tau, alpha):
    thick = Medium(albedo=0.8, tau=1.0, phase=HenyeyGreenstein(0.5))
    with_film = Stack([Interface(IOR, alpha), Medium(albedo=0.9, tau=tau), thick], Lambert(0.5))
    found, plain = (lamina.solve(stack, "preview") for stack in (with_film, Stack([Interface(IOR, alpha), thick],
                                                                                   Lambert(0.5))))
    assert found.reflectance(MU) == pytest.approx(plain.reflectance(MU), rel=1e-3)
    assert found.brdf(0.7, 0.5, 1.0) == pytest.approx(plain.brdf(0.7, 0.5, 1.0), rel=2e-3)


def test_a_layer_of_almost_no_thickness_is_not_there():
    solved = lamina.solve(Stack([Interface(IOR), Medium(albedo=1.0, tau=1e-14), Interface(1.0)]))
    assert solved.brdf(0.7, 0.5, 1.0)[0] == 0.0
    assert solved.absorption(MU) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("tau", [0.0, 1e-6])
def test_a_layer_grown_from_a_thin_one_is_resolved_anew(tau):
    """The nodes need not resolve the peak of a layer that is almost not there."""
    thin = lamina.solve(Stack([Medium(albedo=0.9, tau=tau, phase=HenyeyGreenstein(0.9))], Lambert(0.5)), "preview")
    grown = thin.with_thickness(0, 2.0)
    fresh = lamina.solve(Stack([Medium(albedo=0.9, tau=2.0, phase=HenyeyGreenstein(0.9))], Lambert(0.5)), "preview")
    assert thin.nodes < grown.nodes == fresh.nodes
    assert grown.brdf(0.3, 0.5, 0.0) == pytest.approx(fresh.brdf(0.3, 0.5, 0.0), rel=1e-9)


@pytest.mark.parametrize("quality, tolerance", [("preview", 1e-2), ("final", 1e-3)])
@pytest.mark.parametrize("g", [0.0, -0.7, 0.9])
def test_a_layer_that_needs_no_nodes_keeps_the_tolerance(g, quality, tolerance):
    """Against the solver at its finest nodes; the layer alone, so that its values are relative to nothing else."""
    stack = Stack([Medium(albedo=1.0, tau=1e-2 * tolerance, phase=HenyeyGreenstein(g))])
    found, exact = lamina.solve(stack, quality), lamina.solve(stack, nodes=120)
    mu = MU[:, None]
    assert found.brdf(mu, MU, 1.0) == pytest.approx(exact.brdf(mu, MU, 1.0), rel=tolerance)
    assert found.btdf(mu, MU, 2.0) == pytest.approx(exact.btdf(mu, MU, 2.0), rel=tolerance)


def test_a_thin_layer_in_dense_glass_is_not_resolved_in_vain():
    """More nodes do not help a layer that needs none; its light between total reflections is faint."""
    stack = Stack([Interface(2.567, 0.3), Medium(albedo=0.316, tau=1.2e-8, phase=HenyeyGreenstein(-0.5)),
                   Interface(1.002), Medium(albedo=0.5, tau=0.01), Interface(1.134)], Lambert(0.5))
    solved = lamina.solve(stack, "preview", threads=1)
    assert solved.nodes == 16
