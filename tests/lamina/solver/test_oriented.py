# SPDX-License-Identifier: GPL-3.0-or-later
"""The solver of anisotropic facets: against walks that share no operator with it, against the solver of isotropic
facets, and by symmetries."""

import math
import pickle

import numpy as np
import pytest
from oriented_stacks import GLASS, LOSSLESS, STACKS, crossed, medium, metal, turned
from z_limit import z_limit

import lamina
from lamina import ArgumentError, Conductor, Interface, Lambert, PrincipledBase, SolveError, Stack, StackError, _core
from lamina.solver.core_calls import tolerance_of
from lamina.solver.core_stack import core_stack

VIEWS = 6
SAMPLES = 1 << 15
# Azimuths of all kinds: along the tangents, across, and between; towards the highlight and away from it.
MU_O = np.array([0.9, 0.7, 0.5, 0.35, 0.8, 0.6])
MU_I = np.array([0.8, 0.75, 0.5, 0.6, 0.3, 0.95])
DPHI = np.array([0.2, -0.1, 0.4, 2.8, 1.3, -2.0])
PHI_O = np.array([0.3, 1.5, 2.4, 4.0, 5.5, 0.9])


@pytest.fixture(scope="module")
def solved():
    found = {}

    def one(name):
        if name not in found:
            found[name] = lamina.solve(STACKS[name])
        return found[name]

    return one


def walked(stack, path="reflect", side="top", samples=SAMPLES):
    """(values, standard errors) of all views."""
    runs = [lamina.estimate(stack, *angles[:3], samples=samples, seed=seed, path=path, side=side, phi_o=angles[3])
            for seed, angles in enumerate(zip(MU_O, MU_I, DPHI, PHI_O, strict=True))]
    return np.array([(run.value[0], run.stderr[0]) for run in runs]).T


def scores(found, values, errors):
    return (found - values) / np.hypot(errors, tolerance_of("final") * found)


@pytest.mark.parametrize("name", [name for name in STACKS if name != "bare"])
def test_against_walks(solved, name):
    found = solved(name).brdf(MU_O, MU_I, DPHI, phi_o=PHI_O)[:, 0]
    assert np.abs(scores(found, *walked(STACKS[name]))).max() < z_limit(VIEWS * len(STACKS))


@pytest.mark.parametrize("path, side", [("transmit", "top"), ("transmit", "bottom"), ("reflect", "bottom")])
def test_sheets_against_walks(solved, path, side):
    evaluate = solved("sheet").brdf if path == "reflect" else solved("sheet").btdf
    found = evaluate(MU_O, MU_I, DPHI, side, phi_o=PHI_O)[:, 0]
    assert np.abs(scores(found, *walked(STACKS["sheet"], path, side, 4 * SAMPLES))).max() < z_limit(3 * VIEWS)


def test_a_bare_metal_against_walks(solved):
    """Its light is known in closed form but for the losses, of which the walk has tables."""
    found = solved("bare").brdf(MU_O, MU_I, DPHI, phi_o=PHI_O)[:, 0]
    np.testing.assert_allclose(found, walked(STACKS["bare"])[0], rtol=1e-3)


def test_fluxes_against_walks(solved):
    """Reflectances and transmittances by azimuth."""
    found, values, errors = [], [], []
    for name, path in (("crossed", "reflect"), ("smooth lacquer on brushed metal", "reflect"), ("sheet", "transmit")):
        for mu, phi in ((0.3, 0.2), (0.8, 1.4)):
            run = lamina.estimate(STACKS[name], None, mu, samples=SAMPLES, phi_o=phi, path=path)
            values.append(run.value[0])
            errors.append(run.stderr[0])
            flux = solved(name).reflectance if path == "reflect" else solved(name).transmittance
            found.append(flux(mu, phi=phi)[0])
    assert np.abs(scores(*map(np.array, (found, values, errors)))).max() < z_limit(len(found))


# Below a smooth boundary, lobes cross the critical angle, and their quadrature converges slowly.
@pytest.mark.parametrize("stack, tolerance", [
    (Stack([Interface(GLASS, 0.2), medium(0.8, 0.5, 0.3)], Lambert(0.5)), 1e-4),
    (Stack([medium(0.9, 0.4, 0.5)], Conductor(eta=0.2, k=3.0, alpha=0.2)), 1e-4),
    (Stack([Interface(GLASS)], Conductor(eta=0.2, k=3.0, alpha=0.3)), 1e-3),
], ids=["paint", "dust", "lacquer"])
def test_isotropic_facets_have_the_values_of_the_isotropic_solver(stack, tolerance):
    _, layers, base = core_stack(stack, 0)
    pool = _core.ThreadPool()
    function = _core.solve_oriented(_core.Stack(layers, base), 1e-3, pool)
    known = lamina.solve(stack)
    found = function.points(_core.Side.top, _core.Path.reflect, MU_O, MU_I, DPHI, PHI_O, pool)
    np.testing.assert_allclose(found, known.brdf(MU_O, MU_I, DPHI)[:, 0], rtol=tolerance)
    fluxes = function.fluxes(_core.Side.top, MU_I, PHI_O, pool)
    np.testing.assert_allclose(fluxes.reflected + fluxes.mirrored, known.reflectance(MU_I)[:, 0], rtol=tolerance)
    fluxes = function.diffuse_fluxes(_core.Side.top, pool)
    np.testing.assert_allclose(fluxes.reflected + fluxes.mirrored, known.reflectance("diffuse"), rtol=tolerance)


def test_equal_widths_are_isotropic():
    plain = Stack([Interface(GLASS, 0.2)], Lambert(0.5))
    given = Stack([Interface(GLASS, 0.2, alpha_v=0.2, angle=1.0)], Lambert(0.5))
    assert given.hash == plain.hash
    np.testing.assert_array_equal(lamina.solve(given).brdf(0.8, 0.7, 0.3), lamina.solve(plain).brdf(0.8, 0.7, 0.3))


@pytest.mark.parametrize("name", STACKS)
def test_reciprocity(solved, name):
    found = solved(name).brdf(MU_O, MU_I, DPHI, phi_o=PHI_O)
    np.testing.assert_allclose(solved(name).brdf(MU_I, MU_O, -DPHI, phi_o=PHI_O - DPHI), found, rtol=1e-4)


@pytest.mark.parametrize("name", LOSSLESS)
def test_lossless_stacks_lose_nothing(name):
    function = lamina.solve(LOSSLESS[name])
    for side in ("top", "bottom")[:1 if LOSSLESS[name].base else 2]:
        assert np.abs(function.absorption(MU_I, side, phi=PHI_O)).max() < 1e-4
        assert np.abs(function.absorption("diffuse", side)).max() < 1e-4


@pytest.mark.parametrize("name", ["crossed", "brushed coat on medium on metal"])
def test_turned_tangents_turn_the_values(solved, name):
    by = 0.7
    other = lamina.solve(turned(STACKS[name], by))
    found = other.brdf(MU_O, MU_I, DPHI, phi_o=PHI_O + by)
    np.testing.assert_allclose(found, solved(name).brdf(MU_O, MU_I, DPHI, phi_o=PHI_O), rtol=1e-5)
    np.testing.assert_allclose(other.reflectance(MU_I, phi=PHI_O + by), solved(name).reflectance(MU_I, phi=PHI_O),
                               rtol=1e-5)


@pytest.mark.parametrize("name", ["crossed", "Beckmann"])
def test_a_quarter_turn_exchanges_the_widths(name):
    one = lamina.solve(turned(STACKS[name], 0.5 * math.pi)).brdf(MU_O, MU_I, DPHI, phi_o=PHI_O)
    other = lamina.solve(crossed(STACKS[name])).brdf(MU_O, MU_I, DPHI, phi_o=PHI_O)
    np.testing.assert_allclose(one, other, rtol=1e-4)


def test_facets_across_the_first_ones_equal_those_of_a_turned_surface():
    """Tangents at right angles are solved in four blocks of functions, others in two."""
    coat, rest = Interface(GLASS, 0.1, alpha_v=0.3), medium(0.8, 0.3, 0.5)
    blocks = [lamina.solve(Stack([coat, rest], metal(0.1, 0.3, angle))).brdf(MU_O, MU_I, DPHI, phi_o=PHI_O)
              for angle in (0.5 * math.pi, 0.5 * math.pi + 1e-6)]
    np.testing.assert_allclose(*blocks, rtol=1e-4)


def test_previews_are_close(solved):
    name = "brushed coat on medium on metal"
    final = solved(name).brdf(MU_O, MU_I, DPHI, phi_o=PHI_O)
    preview = lamina.solve(STACKS[name], "preview").brdf(MU_O, MU_I, DPHI, phi_o=PHI_O)
    assert np.sqrt(np.mean((preview - final) ** 2)) < tolerance_of("preview") * np.sqrt(np.mean(final**2))


def test_azimuths_broadcast_and_threads_do_not_matter(solved):
    function = solved("dust on brushed metal")
    found = function.brdf(0.7, 0.6, 0.1, phi_o=PHI_O)
    assert found.shape == (VIEWS, 1)
    assert function.reflectance(MU_I[:, None], phi=PHI_O).shape == (VIEWS, VIEWS, 1)
    np.testing.assert_array_equal(lamina.solve(function.stack, threads=1).brdf(0.7, 0.6, 0.1, phi_o=PHI_O), found)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(function)).brdf(0.7, 0.6, 0.1, phi_o=PHI_O), found)


def test_many_points_in_parts(solved):
    """Points are evaluated some hundred directions at a time."""
    function = solved("smooth lacquer on brushed metal")
    mu, phi = np.linspace(0.05, 1.0, 400), np.linspace(0.0, 6.0, 400)
    found = function.brdf(mu, mu[::-1], 0.3, phi_o=phi)
    some = slice(190, 200)
    np.testing.assert_allclose(function.brdf(mu[some], mu[::-1][some], 0.3, phi_o=phi[some]), found[some], rtol=1e-6)


def test_channels_share_equal_facets():
    stack = Stack([Interface(GLASS, 0.1, alpha_v=0.3)], Lambert([0.1, 0.5, 0.5]))
    function = lamina.solve(stack, "preview")
    found = function.brdf(0.7, 0.6, 0.1, phi_o=0.4)
    assert found.shape == (3,) and found[1] == found[2] > found[0]
    assert set(function.checks) == {"quadrature", "phase", "energy", "reciprocity", "negativity", "azimuth",
                                    "resolution"}


def test_a_shared_boundary_outlives_the_solve_that_made_it():
    lacquer = Interface(1.05, alpha=0.3)
    first = lamina.solve(Stack([lacquer], metal(0.2, 0.4)), "preview")
    second = lamina.solve(Stack([lacquer], metal(0.3, 0.4)), "preview")
    expected = second.reflectance(MU_I, phi=PHI_O)
    del first
    lamina.solve(Stack([Interface(1.3, alpha=0.2)], metal(0.3, 0.2)), "preview")  # takes the memory that was freed
    np.testing.assert_array_equal(second.reflectance(MU_I, phi=PHI_O), expected)


@pytest.mark.parametrize("call, sentence", [
    (lambda s: lamina.solve(s, nodes=32), "nodes = 32: must be left out for a stack with anisotropic facets"),
    (lambda s: lamina.solve(s).grid("reflect", [0.5], [0.5], [0.0]), "base.alpha_v = 0.3: must be left out for a grid"),
    (lambda s: lamina.solve(Stack([Interface(1.5), *s.layers], s.base), "preview").with_thickness(1, 1.0),
     "layers[1]: must be the top layer for another thickness above anisotropic facets"),
    (lambda s: lamina.solve(s, "preview").with_base_reflectance(0.5), "must be left out for another reflectance"),
    (lambda s: lamina.solve(Stack(s.layers, metal(0.01, 0.3))), "facets of width 0.01 are too narrow"),
    (lambda s: lamina.solve(Stack([Interface(1.5), Interface(1.49, 0.3)], metal(0.1, 0.3))),
     "facets between the indices 1.5 and 1.49 refract light into lobes of width 0.003"),
    (lambda s: lamina.solve(Stack([Interface(1.5, 0.1, alpha_v=0.3)], PrincipledBase())),
     "base.kind = 'principled': must be another kind below anisotropic facets"),
])
def test_what_the_solver_refuses(call, sentence):
    with pytest.raises((StackError, ArgumentError, SolveError)) as caught:
        call(STACKS["dust on brushed metal"])
    assert sentence in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize("tau", [0.0, 0.02, 1.7])
@pytest.mark.parametrize("name", ["dust on brushed metal", "crossed"])
def test_another_thickness_on_top_is_a_new_solve(name, tau):
    """What lies below is not solved again. A new solve of the other thickness shares only code."""
    below = STACKS[name]
    stack = Stack([medium(0.9, 0.3, 0.7), *below.layers[name != "crossed":]], below.base)
    other = Stack([medium(0.9, tau, 0.7), *stack.layers[1:]], stack.base)
    changed, new = lamina.solve(stack, "preview").with_thickness(0, tau), lamina.solve(other, "preview")
    assert changed.stack == other
    mu_o, mu_i, dphi, phi_o = np.random.default_rng(8).uniform((0.1, 0.1, -3.0, 0.0), (1.0, 1.0, 3.0, 3.0), (40, 4)).T
    value = new.brdf(mu_o, mu_i, dphi, phi_o=phi_o)
    assert changed.brdf(mu_o, mu_i, dphi, phi_o=phi_o) == pytest.approx(value, rel=1e-4)
    assert changed.reflectance(mu_o, phi=phi_o) == pytest.approx(new.reflectance(mu_o, phi=phi_o), rel=1e-5)
    if tau == 0.0:
        clean = lamina.solve(Stack(stack.layers[1:], stack.base), "preview")
        assert changed.reflectance(mu_o, phi=phi_o) == pytest.approx(clean.reflectance(mu_o, phi=phi_o), rel=1e-5)
