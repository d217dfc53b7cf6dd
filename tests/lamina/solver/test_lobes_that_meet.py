# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of stacks in which light of rough boundaries' lobes meets mirrors and lobes, against the photon walk, which
has no azimuth orders and no nodes: Z-scores at a family-wise level of 1 % (Sidak)."""

import math

import lobe_stacks
import numpy as np
import pytest
from z_limit import z_limit

import lamina
from lamina import Conductor, Interface, Stack
from lamina.walks.estimate import Query

COUNT = 30
LIMIT = z_limit(COUNT)
TOLERANCE = 1e-3  # of solve at quality "final"
LEAST = 1e-3  # 1/sr; the tolerance of smaller values is relative to this one
LACQUERED = Stack([Interface(1.5)], Conductor(0.2, 3.0, 0.05))
FROSTED_ABOVE = Stack([Interface(1.5, 0.1), Interface(1.0)])


def z_score(stack, query, samples):
    solved = lamina.solve(stack, threads=1)
    kernel = solved.brdf if query.path == "reflect" else solved.btdf
    value = kernel(query.mu_o, query.mu_i, query.dphi, query.side)[0]
    walk = lamina.estimate(stack, query.mu_o, query.mu_i, query.dphi, samples=samples, seed=7, threads=1,
                           side=query.side, path=query.path)
    own = TOLERANCE * max(value, LEAST)
    return (value - walk.value[0]) / math.hypot(walk.stderr[0], own)


def test_a_narrow_lobe_inside():
    """Between indices of 1.67 and 1.59 a lobe is some .002 radians wide: its value alone is found once in a million."""
    stack, query = lobe_stacks.case(23)
    value = lamina.solve(stack).brdf(query.mu_o, query.mu_i, query.dphi)
    for seed in range(4):
        found = lamina.estimate(stack, query.mu_o, query.mu_i, query.dphi, samples=1 << 15, seed=seed,
                                side=query.side, path=query.path)
        assert found.stderr < 0.02 * found.value
        assert abs(value - found.value) < 4.0 * found.stderr


def test_compensation_at_grazing_views():
    """Facets of alpha .056 at cosines of .12 and .05, where what single scattering loses changes quickly."""
    assert abs(z_score(*lobe_stacks.case(125), 1 << 14)) < 3.0


@pytest.mark.parametrize("number", range(COUNT))
def test_random_stacks(number):
    assert abs(z_score(*lobe_stacks.case(number), 1 << 14)) < LIMIT


@pytest.mark.parametrize("stack, mu_o, mu_i, dphi", [
    (LACQUERED, 0.2, 0.2, 1.31),
    (LACQUERED, 0.5, 0.5, 0.7),
    (FROSTED_ABOVE, 0.3, 0.3, 0.0),
    (FROSTED_ABOVE, 0.5, 0.5, 0.7),
])
def test_the_flanks_of_narrow_lobes(stack, mu_o, mu_i, dphi):
    assert abs(z_score(stack, Query(mu_o, mu_i, dphi), 1 << 16)) < z_limit(4)


@pytest.mark.parametrize("stack", [LACQUERED, FROSTED_ABOVE])
def test_nothing_is_negative_and_all_is_reciprocal(stack):
    solved = lamina.solve(stack, threads=1)
    mu, dphi = np.array([0.05, 0.2, 0.5, 0.8, 1.0]), np.linspace(0.0, math.pi, 7)
    values = solved.grid("reflect", mu, mu, dphi)
    assert values.min() >= 0.0
    assert values == pytest.approx(values.swapaxes(0, 1), rel=1e-6)
    assert solved.checks["negativity"] < TOLERANCE and solved.checks["azimuth"] < TOLERANCE


@pytest.mark.parametrize("tau", [0.0, 0.01, 0.1, 0.5])
def test_a_thinner_layer_above_is_resolved_anew(tau):
    """Thin dust hides less of the lobes below: more azimuth orders are needed than under thick dust."""
    dust = lamina.Medium(albedo=0.8, tau=0.5, phase=lamina.HenyeyGreenstein(0.5), varying=True)
    metal = Conductor(0.27, 3.61, 0.2)
    varied = lamina.solve(Stack([dust, Interface(1.5, 0.1)], metal), "preview", threads=1).with_thickness(0, tau)
    thin = lamina.Medium(albedo=0.8, tau=tau, phase=dust.phase)
    fixed = lamina.solve(Stack([thin, Interface(1.5, 0.1)], metal), "preview", threads=1)
    assert varied.checks["azimuth"] < 1e-2
    for dphi in (0.0, 0.7, 2.0):
        assert varied.brdf(0.6, 0.7, dphi) == pytest.approx(fixed.brdf(0.6, 0.7, dphi), rel=1e-2)


@pytest.mark.parametrize("tau", [0.002, 0.0049, 0.03])
def test_the_grazing_light_of_a_thinner_layer_is_resolved_anew(tau):
    """Errors of this light added up from lobe to lobe, to 27 %, on the nodes of the thicker layer."""
    below = [Interface(1.335, 0.161, distribution="beckmann")]
    mirror = Conductor(facing=0.338, grazing=0.871)
    thick, thin = (Stack([lamina.Medium(1.0, t, lamina.CornetteShanks(0.59)), *below], mirror) for t in (1.73, tau))
    mu, dphi = np.array([0.05, 0.13, 0.37, 0.62, 0.88, 1.0]), np.array([0.0, 0.4, 1.3, 2.4, math.pi])
    grown = lamina.solve(thick, "preview").with_thickness(0, tau).grid("reflect", mu, mu, dphi)
    assert grown == pytest.approx(lamina.solve(thin, "preview").grid("reflect", mu, mu, dphi), rel=1e-2, abs=1e-5)


def test_facets_that_gain_light_are_refused_by_a_bake_too():
    dust = lamina.Medium(0.9, 0.016)
    stack = Stack([Interface(3.6355, 0.0076573, distribution="beckmann"), Interface(1.0), dust], lamina.Lambert(0.5))
    with pytest.raises(lamina.SolveError, match="gains .* of its flux"):
        lamina.bake(stack, "preview")
