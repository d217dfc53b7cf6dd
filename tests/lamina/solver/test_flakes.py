# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers of flakes: against random walks, which sample flakes one by one, a medium in a limit, integrals over single
flakes, energy, reciprocity, refusals."""

import math

import numpy as np
import pytest
from solver_and_walks import beyond_the_first, compared, exchanged, z_scores
from z_limit import z_limit

import lamina
from lamina import Conductor, Flakes, Interface, Isotropic, Lambert, Medium, Stack, StackError

ALUMINIUM = lamina.metals.flakes("aluminium", 0.5, 0.15)
GOLD = lamina.metals.flakes("gold", 1.5, 0.3)
PEARL = Flakes(0.7, 0.3, reflectance=1.0)
COAT = Interface(1.5)
STACKS = {
    "bare over black": Stack([Flakes(0.8, 0.15, reflectance=0.9)], Lambert(0.0)),
    "sheet": Stack([PEARL]),
    "under a smooth coat": Stack([COAT, ALUMINIUM], Lambert([0.3, 0.1, 0.05])),
    "under a rough coat": Stack([Interface(1.5, 0.1), ALUMINIUM], Lambert(0.05)),
    "gold under a rougher coat": Stack([Interface(1.5, 0.3), GOLD], Lambert(0.05)),
    "tinted over a bright base": Stack([Flakes(0.7, 0.2, reflectance=0.8, binder=[0.1, 0.4, 1.0])], Lambert(0.8)),
    "over metal": Stack([COAT, Flakes(0.4, 0.2, reflectance=0.7)], Conductor(0.2, 3.2, 0.2)),
    "thick": Stack([COAT, Flakes(30.0, 0.2, reflectance=0.95)]),
    "over paint": Stack([COAT, ALUMINIUM, Medium(0.9, 1.0, lamina.HenyeyGreenstein(0.6))], Lambert(0.3)),
    "two layers": Stack([COAT, Flakes(0.3, 0.3, reflectance=[0.9, 0.6, 0.3]), Flakes(1.0, 0.15, reflectance=0.8)],
                        Lambert(0.1)),
}
POINTS = [(1.0, 0.9, 0.0), (0.9, 0.5, 0.0), (0.7, 0.7, 0.3), (0.5, 0.3, 1.0), (0.2, 0.6, math.pi), (0.8, 0.2, 2.0)]
MU = np.array([0.06, 0.3, 0.6, 0.95])


@pytest.mark.parametrize("stack", STACKS.values(), ids=STACKS)
def test_against_walks(stack):
    """Walks share the distribution of normals and the projected area with the solver, and nothing else."""
    is_sheet = stack.base is None and not isinstance(stack.layers[0], Interface)
    value, walk, error = compared(stack, POINTS, MU, is_sheet)
    z = z_scores(value, walk, error)
    assert np.abs(z).max() < z_limit(z.size)
    assert np.median(error / walk) < 0.01  # the walks see errors of this size


def test_light_beyond_the_first_reflection():
    """The bar: .2 % rms of the light that several flakes reflected, against walks of that noise."""
    stack = Stack([Flakes(1.0, 0.3, reflectance=0.9)], Lambert(0.0))
    points = [(o, i, p) for o in (0.3, 0.7, 1.0) for i in (0.4, 0.9) for p in (1.0, 2.5)]
    # Light of one flake is proportional to the reflectance, so a faint copy of the stack shows it alone.
    faint = 1e-5
    once = lamina.solve(Stack([Flakes(1.0, 0.3, reflectance=faint)], Lambert(0.0)))
    beyond, off, noise = beyond_the_first(stack, lambda *point: 0.9 / faint * once.brdf(*point)[0], points, 1 << 22)
    assert off < 0.002 * beyond + 1.5 * noise
    assert noise < 0.003 * beyond


@pytest.mark.parametrize("tau", [0.2, 3.0])
def test_spheres_are_an_isotropic_medium(tau):
    """Flakes of spread 1 show the same area from all sides and reflect light evenly."""
    flakes, medium = (lamina.solve(Stack([COAT, layer], Lambert(0.4)))
                      for layer in (Flakes(tau, 1.0, reflectance=0.8), Medium(0.8, tau, Isotropic())))
    dphi = np.array([0.0, 1.0, math.pi])
    assert np.allclose(flakes.grid("reflect", MU, MU, dphi), medium.grid("reflect", MU, MU, dphi), rtol=1e-4)
    assert np.allclose(flakes.reflectance(MU), medium.reflectance(MU), rtol=1e-5)


@pytest.mark.parametrize("alpha", [0.1, 0.15, 0.3, 0.7])
@pytest.mark.parametrize("tau", [0.05, 1.0, 20.0])
def test_energy_of_white_flakes(alpha, tau):
    solved = lamina.solve(Stack([Flakes(tau, alpha, reflectance=1.0)]), "preview")
    whole = solved.reflectance(MU) + solved.transmittance(MU)
    assert np.allclose(whole, 1.0, rtol=0.0, atol=1e-4)


@pytest.mark.parametrize("stack", STACKS.values(), ids=STACKS)
def test_reciprocity(stack):
    values, others = exchanged(stack, MU)
    assert np.allclose(values, others, rtol=1e-4)
    assert np.all(values > 0.0)


def single(flakes, mu_o, mu_i, dphi):
    """BRDF of light that one flake of a thin layer reflects, per optical thickness, by the normal of that flake."""
    out = np.array([math.sqrt(1 - mu_o**2) * math.cos(dphi), math.sqrt(1 - mu_o**2) * math.sin(dphi), mu_o])
    to_light = np.array([-math.sqrt(1 - mu_i**2), 0.0, mu_i])
    half = (out + to_light) / np.linalg.norm(out + to_light)
    stretched = half / [flakes.alpha, flakes.alpha, 1.0]
    density = 1.0 / (math.pi * flakes.alpha**2 * (stretched @ stretched) ** 2)
    return flakes.reflectance * density / (4.0 * mu_o * mu_i)


def test_thin_layers_reflect_once():
    flakes = Flakes(1e-6, 0.2, reflectance=0.5)
    solved = lamina.solve(Stack([flakes], Lambert(0.0)))
    for o, i, p in POINTS:
        assert solved.brdf(o, i, p)[0] == pytest.approx(1e-6 * single(flakes, o, i, p), rel=1e-4)


def test_nothing_is_left_of_no_flakes():
    bare = lamina.solve(Stack([COAT], Lambert(0.3)))
    none = lamina.solve(Stack([COAT, Flakes(0.0, 0.2, reflectance=0.9)], Lambert(0.3)))
    assert np.allclose(none.brdf(MU, MU, 0.3), bare.brdf(MU, MU, 0.3), rtol=1e-9)


@pytest.mark.parametrize(("alpha", "low", "high"), [(0.15, 0.15, 0.19), (0.3, 0.21, 0.26)])
def test_share_of_repeated_reflection(alpha, low, high):
    """What flake maps ignore: a sixth to a quarter of the light of white flakes that hide 63 % of what is below."""
    flakes, faint = (lamina.solve(Stack([Flakes(1.0, alpha, reflectance=r)], Lambert(0.0))) for r in (1.0, 1e-6))
    once = 1e6 * faint.reflectance("diffuse")
    share = 1.0 - once / flakes.reflectance("diffuse")
    assert low < share[0] < high


def test_metal_follows_its_binder():
    """A thin layer below a coat and a bare one differ by the metal's factor: less contrast in the binder."""
    metal = lamina.metals.conductor("gold")
    eta, k = lamina.metals.indices_of(metal, 3, "gold")
    flakes = lamina.metals.flakes("gold", 1e-6, 0.3)
    bare = lamina.solve(Stack([flakes], Lambert(0.0))).brdf(1.0, 1.0, 0.0)
    coated = lamina.solve(Stack([COAT, flakes], Lambert(0.0))).brdf(1.0, 1.0, 0.0)
    passed = 0.96**2 / 1.5**2

    def facing(n):
        return np.array([abs((complex(e, x) / n - 1) / (complex(e, x) / n + 1)) ** 2
                         for e, x in zip(eta, k, strict=True)])

    assert np.allclose(coated / bare, passed * facing(1.5) / facing(1.0), rtol=1e-3)


def test_another_thickness():
    stack = Stack([COAT, Flakes([2.0, 1.0, 0.5], 0.2, reflectance=0.9, binder=[0.2, 0.2, 0.1])], Lambert(0.1))
    thinner = lamina.solve(stack).with_thickness(1, [1.1, 0.6, 0.3])
    assert thinner.stack.layers[1].tau == pytest.approx((1.0, 0.5, 0.25))
    assert thinner.stack.layers[1].binder == pytest.approx((0.1, 0.1, 0.05))
    assert np.allclose(thinner.brdf(0.8, 0.5, 1.0), lamina.solve(thinner.stack).brdf(0.8, 0.5, 1.0), rtol=2e-4)


COATED = STACKS["under a smooth coat"]
BRUSHED = Stack([Interface(1.5, 0.1, alpha_v=0.3), ALUMINIUM], Lambert(0.3))


@pytest.mark.parametrize(("use", "words"), [
    (lambda: lamina.searchlight(COATED), "a searchlight"),
    (lambda: lamina.estimate_searchlight(COATED), "a searchlight"),
    (lambda: lamina.estimate(COATED, 0.5, 0.5, method="adding"), "method 'adding'"),
    (lambda: lamina.estimate(COATED, 0.5, 0.5, method="scattering"), "method 'scattering'"),
    (lambda: lamina.subsurface_nodes(COATED), "subsurface scattering"),
    (lambda: lamina.portal_tables(COATED), "a portal"),
    (lambda: lamina.interior_of_stack(COATED), "light inside a body"),
    (lambda: lamina.solve(BRUSHED), "a solve with anisotropic facets"),
    (lambda: lamina.bake(BRUSHED, basis="moving"), "a solve with anisotropic facets"),
], ids=lambda case: case if isinstance(case, str) else "")
def test_refusals(use, words):
    with pytest.raises(StackError, match=rf"layers\[1\].kind = 'flakes': must be left out for {words}; lamina.solve"):
        use()
