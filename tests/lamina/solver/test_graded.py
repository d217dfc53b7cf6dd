# SPDX-License-Identifier: GPL-3.0-or-later
"""Media with profiles in stacks: from below, under boundaries, baked; walks against the solver, and an independent
solver."""

import math

import numpy as np
import pytest
from walk_cases import solved_value

import lamina
from lamina import (
    Black,
    Conductor,
    HenyeyGreenstein,
    Interface,
    Knot,
    Lambert,
    Medium,
    Rayleigh,
    Stack,
    StackError,
    _core,
)
from lamina.solver.core_stack import core_stack
from lamina.walks.estimate import Query

SAMPLES = 1 << 15
LIMIT = 3.7  # 1 % over all walks here, Bonferroni
FOG = Medium(tau=1.5, profile=[Knot(0.0, 0.95, HenyeyGreenstein(0.6)), Knot(0.5, 0.9), Knot(0.5, 0.4), Knot(1.0, 0.8)])
SILT = Medium(tau=0.8, phase=HenyeyGreenstein(0.3), profile=[Knot(0.0, 0.2), Knot(1.0, 0.95)])
CLEAR = Medium(albedo=0.8, tau=0.5, phase=Rayleigh())

CASES = {
    "alone": (Stack([FOG]), Query(0.5, 0.7, 1.0)),
    "alone from below": (Stack([FOG]), Query(0.5, 0.7, 1.0, "bottom")),
    "through": (Stack([FOG]), Query(0.4, 0.9, 2.0, path="transmit")),
    "through from below": (Stack([FOG]), Query(0.4, 0.9, 2.0, "bottom", "transmit")),
    "albedo": (Stack([FOG]), Query(None, 0.4)),
    "transmittance from below": (Stack([FOG]), Query(None, 0.4, 0.0, "bottom", "transmit")),
    "two over Lambert": (Stack([SILT, FOG], Lambert(0.6)), Query(0.3, 0.8, 2.0)),
    "sheet of three from below": (Stack([FOG, CLEAR, SILT]), Query(0.3, 0.8, 2.0, "bottom")),
    "varnish": (Stack([Interface(1.5), SILT], Lambert(0.5)), Query(0.7, 0.5, 1.0)),
    "rough varnish": (Stack([Interface(1.4, 0.3), SILT], Lambert(0.5)), Query(0.7, 0.5, 1.0)),
    "on metal": (Stack([SILT], Conductor(0.4, 2.5, alpha=0.3)), Query(0.7, 0.5, 1.0)),
}


def walked(stack, query, method, seed=1):
    found = lamina.estimate(stack, query.mu_o, query.mu_i, query.dphi, method, SAMPLES, seed=seed, threads=1,
                            side=query.side, path=query.path)
    return found.value[0], found.stderr[0], found.table_error


@pytest.mark.parametrize("method", ["transfer", "adding"])
@pytest.mark.parametrize("name", CASES)
def test_walks_against_the_solver(name, method):
    stack, query = CASES[name]
    truth = solved_value(lamina.solve(stack, threads=1), query)
    value, error, off = walked(stack, query, method)
    # The solver's tolerance is 1e-3; homogeneous stacks have less than a tenth of it, and so have slices.
    assert abs(value - truth) / math.hypot(error, max(off, 1e-4) * truth) < LIMIT


@pytest.mark.parametrize("walk", ["slab_scattering_walk", "guided_transfer_walk"])
@pytest.mark.parametrize("reflectance", [0.0, 0.7])
def test_every_scattering_walk(walk, reflectance):
    """Thin enough for a walk without tables."""
    stack = Stack([SILT, Medium(albedo=0.5, tau=0.2)], Lambert(reflectance))
    check_scattering_walk(stack, walk)


@pytest.mark.parametrize("reflectance", [0.0, 0.7])
@pytest.mark.parametrize("layers", [
    [Medium(albedo=0.9, tau=1.0)],
    [Medium(tau=1.0, profile=[Knot(0.0, 0.9), Knot(1.0, 0.2)]), Medium(albedo=0.0, tau=0.3),
     Medium(albedo=1.0, tau=2.0)],
])
def test_isotropic_walk(layers, reflectance):
    check_scattering_walk(Stack(layers, Lambert(reflectance)), "isotropic_walk")


def test_thin_scatterer_between_absorbers():
    """Where a guide's own heights do not scatter."""
    layers = [Medium(albedo=0.0, tau=2.0), Medium(albedo=0.9, tau=0.01, phase=HenyeyGreenstein(0.2)),
              Medium(albedo=0.0, tau=2.0)]
    check_scattering_walk(Stack(layers), "guided_transfer_walk")
    spike = Medium(tau=3.0, phase=HenyeyGreenstein(0.2), profile=[
        Knot(depth, albedo) for depth, albedo in
        [(0, 0), *[(0.05 * k, 0.01 * (k % 2)) for k in range(1, 15)], (0.78, 0), (0.8, 0.9), (0.82, 0), (1, 0)]])
    check_scattering_walk(Stack([spike]), "guided_transfer_walk")


def check_scattering_walk(stack, walk):
    query = Query(0.6, 0.4, 1.0)
    _, layers, base = core_stack(stack, 0)
    joined = _core.joined_media(_core.Stack(layers, base))
    pool = _core.ThreadPool(1)
    truth = _core.scattering_ode(joined, [query.mu_o, query.mu_i], [query.dphi], pool, 24, 1e-8)["brdf"][0, 1, 0]
    directions = (query.mu_o, query.mu_i, query.dphi)
    made = getattr(_core, walk)(joined, *directions[:2 if walk == "isotropic_walk" else 3])
    total, squares, _, count, _ = _core.run_walk(made, 3, 0, 8, pool)
    mean = total / count
    error = math.sqrt((squares / count - mean**2) / count)
    assert abs(mean - truth) / math.hypot(error, 1e-5 * truth) < LIMIT


@pytest.mark.parametrize("stack, words", [
    (Stack([Interface(1.5), SILT]), "boundaries"),
    (Stack([Medium(albedo=0.5, tau=math.inf)]), "infinitely thick media"),
    (Stack([SILT], Conductor(0.4, 2.5)), "this base"),
    (Stack([], Lambert(0.5)), "a stack without media"),
])
def test_what_the_scattering_walk_does_not_know(stack, words):
    with pytest.raises(StackError, match=f"method = 'scattering': .* do not support {words}: .*; use 'transfer'"):
        lamina.estimate(stack, 0.5, 0.5, 0.0, "scattering", 4096)


def test_upside_down():
    """A sheet from below is its mirror image from above."""
    solved = lamina.solve(Stack([FOG, CLEAR]), threads=1)
    turned = lamina.solve(Stack([CLEAR, FOG.checked("fog").turned()]), threads=1)
    mu, dphi = np.array([0.1, 0.5, 1.0]), np.array([0.0, 2.0])
    np.testing.assert_allclose(solved.grid("reflect", mu, mu, dphi, "bottom"), turned.grid("reflect", mu, mu, dphi),
                               rtol=1e-6)
    np.testing.assert_allclose(solved.grid("transmit", mu, mu, dphi, "bottom"), turned.grid("transmit", mu, mu, dphi),
                               rtol=1e-6)


def test_against_disort():
    """PythonicDISORT on many layers, each with the profile's value at its middle, extrapolated in their number."""
    from disort_oracle import pythonic
    tau = 2.0
    stack = Stack([Medium(tau=tau, profile=[Knot(0.0, 0.9), Knot(1.0, 0.3)])], Lambert(0.4))

    def layered(count):
        middle = (np.arange(count) + 0.5) / count
        return pythonic([(0.9 - 0.6 * x, tau / count, lamina.Isotropic()) for x in middle], 0.6, 0.4, streams=32)

    coarse, fine = layered(32), layered(64)
    visible = fine.mu >= 0.1
    solved = lamina.solve(stack, threads=1)
    truth = fine.reflectance + (fine.reflectance - coarse.reflectance) / 3.0
    assert solved.reflectance(0.6)[0] == pytest.approx(truth, rel=2e-5)
    truth = (fine.brdf(1.0) + (fine.brdf(1.0) - coarse.brdf(1.0)) / 3.0)[visible]
    np.testing.assert_allclose(solved.brdf(fine.mu[visible], 0.6, 1.0)[:, 0], truth, rtol=5e-4)


def test_conservative_profiles_keep_energy():
    medium = Medium(tau=3.0, profile=[Knot(0.0, 1.0, HenyeyGreenstein(0.6)), Knot(1.0, 1.0, Rayleigh())])
    solved = lamina.solve(Stack([medium]), threads=1)
    np.testing.assert_allclose(solved.absorption([0.1, 0.5, 1.0]), 0.0, atol=2e-5)
    assert solved.checks["energy"] < 5e-7


def test_millimetres():
    """Coefficients that are linear in depth, against thin layers of their means."""
    top, bottom, count = (1.0, 0.1), (2.0, 1.5), 60
    ends = [Knot(0.0, sigma_s=top[0], sigma_a=top[1]), Knot(1.0, sigma_s=bottom[0], sigma_a=bottom[1])]
    solved = lamina.solve(Stack([Medium(thickness=1.0, profile=ends)], Lambert(0.5)), threads=1)
    layers = []
    for k in range(count):
        x = (k + 0.5) / count
        layers.append(Medium(sigma_s=top[0] + x * (bottom[0] - top[0]), sigma_a=top[1] + x * (bottom[1] - top[1]),
                             thickness=1.0 / count))
    fine = lamina.solve(Stack(layers, Lambert(0.5)), threads=1, nodes=24)
    for mu in (0.3, 0.7, 1.0):
        assert solved.reflectance(mu)[0] == pytest.approx(fine.reflectance(mu)[0], rel=4e-4)


class TestBake:
    def test_constant_profile(self):
        """As the homogeneous layer, to 1e-6."""
        constant = Medium(tau=1.0, profile=[Knot(0.0, 0.8), Knot(1.0, 0.8)])
        graded = lamina.bake(Stack([constant], Lambert(0.3)), "preview", threads=1)
        alone = lamina.bake(Stack([Medium(tau=1.0, albedo=0.8)], Lambert(0.3)), "preview", threads=1)
        assert graded.header["closures"] == alone.header["closures"]
        np.testing.assert_allclose(graded.weights, alone.weights, atol=1e-6)
        assert graded.header["stack_hash"] != alone.header["stack_hash"]

    def test_report_and_varying_thickness(self):
        knots = [Knot(0.0, [0.9, 0.5, 0.3], HenyeyGreenstein(0.5)), Knot(1.0, 0.9)]
        layer = Medium(tau=2.0, varying=True, profile=knots)
        made = lamina.bake(Stack([layer], Black()), "preview", threads=1, row_stride=16, nodes=16)
        assert made.header["axes"]["tau"]["layer"] == 0 and made.header["report"]["energy_error"] < 5e-7
        assert made.header["report"]["albedo_error"] < 0.02

    def test_sheet_has_two_sides(self):
        made = lamina.bake(Stack([SILT]), "preview", threads=1, nodes=16)
        assert made.header["sides"] == ["top", "bottom"]
        even = Medium(tau=0.8, profile=[Knot(0.0, 0.2), Knot(0.5, 0.9), Knot(1.0, 0.2)])
        assert lamina.bake(Stack([even]), "preview", threads=1, nodes=16).header["sides"] == ["top"]


def test_a_medium_that_ends_without_scattering_below_a_denser_one():
    """Beside the critical angle the nodes have small weights: rounding errors of sublayers of albedo 1e-5 counted as
    negative light, the more the finer the nodes."""
    knots = [Knot(0.0, 1.0, HenyeyGreenstein(0.89)), Knot(0.7, 0.001, HenyeyGreenstein(-0.14)), Knot(1.0, 0.0)]
    solved = lamina.solve(Stack([Interface(1.72), Medium(tau=2.9, profile=knots)], Lambert(0.5)), "preview")
    assert solved.checks["negativity"] < 1e-3 and solved.nodes <= 56
