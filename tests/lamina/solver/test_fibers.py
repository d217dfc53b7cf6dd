# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers of fibers: against random walks, which draw the side of a fiber that light meets, a quadrature over these
sides, energy, reciprocity, bakes, refusals."""

import math

import numpy as np
import pytest
from solver_and_walks import beyond_the_first, compared, exchanged, z_scores
from z_limit import z_limit

import lamina
from lamina import Conductor, Fibers, Interface, Lambert, Medium, Stack, StackError

COAT = Interface(1.5)
STACKS = {
    "velvet": Stack([Fibers(3.0, 0.2, [0.6, 0.1, 0.1], 0.3)], Lambert(0.1)),
    "opaque sheet": Stack([Fibers(0.7, 0.8, 0.9)]),
    "fluff over metal": Stack([Fibers(0.3, 1.5, 0.8, 0.5)], Conductor(0.2, 3.2, 0.2)),
    "under a coat": Stack([COAT, Fibers(0.7, 0.5, 0.9, 0.3)], Lambert(0.3)),
    "upright and dense": Stack([Fibers(20.0, 0.05, 0.95, 0.2)]),
    "over paint": Stack([Fibers(0.5, 0.4, 0.9, 0.5), COAT, Medium(0.8, 1.0)], Lambert(0.3)),
}
POINTS = [(1.0, 0.9, 0.0), (0.9, 0.5, math.pi), (0.7, 0.7, 3.0), (0.5, 0.3, 1.0), (0.2, 0.3, 2.0), (0.1, 0.1, 0.0)]
MU = np.array([0.06, 0.3, 0.6, 0.95])


@pytest.mark.parametrize("stack", STACKS.values(), ids=STACKS)
def test_against_walks(stack):
    off = z_scores(*compared(stack, POINTS, MU, stack.base is None))
    assert np.abs(off).max() < z_limit(np.size(off))


def test_light_beyond_the_first_scattering():
    """The bar: .2 % rms of the light that several fibers scattered, against walks of that noise."""
    stack, faint = (Stack([Fibers(3.0, 0.3, r, 0.3)], Lambert(0.0)) for r in (0.9, 1e-5))
    single = lamina.solve(faint)
    points = [(o, i, p) for o in (0.3, 0.9) for i in (0.4, 0.8) for p in (1.0, 2.5)]
    beyond, off, noise = beyond_the_first(stack, lambda *point: 0.9e5 * single.brdf(*point)[0], points, 1 << 22)
    assert off < 0.002 * beyond + 1.5 * noise
    assert noise < 0.003 * beyond


def once(fibers, mu_o, mu_i, dphi):
    """BRDF of light that one fiber of a thin layer scatters, per amount: a sum over 4000 x 300 normals of sides."""
    out = np.array([math.sqrt(1 - mu_o**2) * math.cos(dphi), math.sqrt(1 - mu_o**2) * math.sin(dphi), mu_o])
    to_light = np.array([-math.sqrt(1 - mu_i**2), 0.0, mu_i])
    height = (np.arange(4000)[:, None] + 0.5) / 2000.0 - 1.0  # on the sphere of stretched normals
    turn = (np.arange(300) + 0.5) * math.pi / 150.0
    stretched = np.sqrt(height**2 + fibers.alpha**2 * (1.0 - height**2))
    across = fibers.alpha * np.sqrt(1.0 - height**2) / stretched
    normal = [across * np.cos(turn), across * np.sin(turn), height / stretched * np.ones_like(turn)]
    seen, lit = (np.tensordot(one, normal, 1) for one in (out, to_light))
    weight = stretched / math.pi / 2000.0 * math.pi / 150.0
    back = np.sum(np.maximum(seen, 0.0) * np.maximum(lit, 0.0) * weight)
    through = np.sum(np.maximum(-seen, 0.0) * np.maximum(lit, 0.0) * weight)
    share = fibers.reflectance * ((1.0 - fibers.translucency) * back + fibers.translucency * through)
    return fibers.seen_from_above * share / (math.pi * mu_o * mu_i)


@pytest.mark.parametrize("tilt", [0.05, 0.35, 1.2])
def test_thin_layers_scatter_once(tilt):
    fibers = Fibers(1e-6, tilt, 0.5, 0.3)
    solved = lamina.solve(Stack([fibers], Lambert(0.0)))
    for point in POINTS:
        assert solved.brdf(*point)[0] == pytest.approx(1e-6 * once(fibers, *point), rel=3e-4)


def test_the_area_of_leaning_cylinders():
    """Against random cylinders: along the normal and along the layer the area is theirs."""
    rng = np.random.default_rng(1)
    for tilt in (0.05, 0.5, 1.0, 0.5 * math.pi):
        fibers, phi = Fibers(1.0, tilt, 0.5), rng.uniform(0.0, 2.0 * math.pi, 100000)
        along = np.sqrt(1.0 - (math.sin(tilt) * np.cos(phi)) ** 2)
        off = along.mean() - fibers.alpha * fibers.seen_from_above
        assert abs(off) < 4.0 * along.std() / math.sqrt(along.size) + 1e-6
        assert fibers.optics(0)[1] == pytest.approx(math.sin(tilt))


@pytest.mark.parametrize("tilt", [0.05, 0.35, 1.0, 0.5 * math.pi])
@pytest.mark.parametrize("tau", [0.05, 1.0, 50.0])
def test_energy_of_white_fibers(tilt, tau):
    solved = lamina.solve(Stack([Fibers(tau, tilt, 1.0, 0.3)]), "preview")
    assert np.allclose(solved.reflectance(MU) + solved.transmittance(MU), 1.0, rtol=0.0, atol=1e-4)


@pytest.mark.parametrize("stack", STACKS.values(), ids=STACKS)
def test_reciprocity(stack):
    values, others = exchanged(stack, MU)
    assert np.allclose(values, others, rtol=1e-4)
    assert np.all(values > 0.0)


def test_velvet_has_a_bright_rim():
    """The share that a ray meets grows towards grazing views, where light did not go deep."""
    velvet = lamina.solve(STACKS["velvet"])
    rim = velvet.brdf(0.1, 0.6, 1.5) / velvet.brdf(1.0, 0.6, 0.0)
    assert np.all(rim > 2.0)
    paint = lamina.solve(Stack([Medium(albedo=[0.6, 0.1, 0.1], tau=3.0)], Lambert(0.1)))
    assert np.all(rim > 1.5 * paint.brdf(0.1, 0.6, 1.5) / paint.brdf(1.0, 0.6, 0.0))


def test_another_thickness():
    solved = lamina.solve(Stack([Fibers([2.0, 1.0, 0.5], 0.5, 0.9)], Lambert(0.1)))
    thinner = solved.with_thickness(0, [0.5, 0.3, 0.1])
    assert thinner.stack.layers[0].tau == pytest.approx(np.array([0.5, 0.3, 0.1]) / math.sin(0.5))
    assert np.allclose(thinner.brdf(0.8, 0.5, 1.0), lamina.solve(thinner.stack).brdf(0.8, 0.5, 1.0), rtol=2e-4)


@pytest.mark.parametrize(("stack", "basis", "mean", "worst"), [
    (STACKS["velvet"], "standard", 0.12, 0.19),  # dark near the normal, where no closure has a dip
    (STACKS["velvet"], "moving", 0.09, 0.13),
    (Stack([Fibers(3.0, 0.6, 0.4, 0.4)], Lambert(0.05)), "moving", 0.025, 0.06),
    (Stack([Fibers(0.5, 1.4, 0.75, 0.4, varying=True)], Lambert(0.3)), "standard", 0.03, 0.08),
])
def test_tables(stack, basis, mean, worst):
    report = lamina.bake(stack, "preview", basis=basis).report
    assert report["fit_error"] < mean and report["worst_slice"]["error"] < worst
    assert report["albedo_error"] < 1e-6


@pytest.mark.parametrize("stack", STACKS.values(), ids=STACKS)
def test_json(stack):
    assert Stack.from_json(stack.to_json()) == stack


@pytest.mark.parametrize("use", [
    lamina.searchlight, lamina.estimate_searchlight, lamina.subsurface_nodes, lamina.portal_tables,
    lamina.interior_of_stack, lambda stack: lamina.estimate(stack, 0.5, 0.5, method="adding"),
    lambda stack: lamina.solve(Stack([*stack.layers, Interface(1.5, 0.1, alpha_v=0.3)], stack.base)),
])
def test_refusals(use):
    with pytest.raises(StackError, match=r"layers\[0\].kind = 'fibers': must be left out for .*; lamina.solve"):
        use(STACKS["velvet"])
