# SPDX-License-Identifier: GPL-3.0-or-later
"""Retroreflectors: against random walks, which turn single rays, a metal seen from the other side, energy, reciprocity,
bakes, refusals."""

import math

import numpy as np
import pytest
from solver_and_walks import beyond_the_first, compared, exchanged, z_scores
from z_limit import z_limit

import lamina
from lamina import Conductor, Flakes, HenyeyGreenstein, Interface, Medium, Retroreflector, Stack, StackError

COAT = Interface(1.5)
PAINT = Medium([0.9, 0.5, 0.2], 0.5, HenyeyGreenstein(0.6))
STACKS = {
    "under a smooth coat": Stack([COAT], Retroreflector([0.7, 0.4, 0.1], 0.1)),
    "under a rough coat": Stack([Interface(1.5, 0.1)], Retroreflector(0.7, 0.1)),
    "under paint": Stack([PAINT], Retroreflector(0.8, 0.15)),
    "sign": Stack([COAT, PAINT], Retroreflector(0.8, 0.15)),
    "below flakes": Stack([COAT, Flakes(0.4, 0.2, reflectance=0.7)], Retroreflector(0.8, 0.15)),
}
POINTS = [(1.0, 0.9, 0.0), (0.9, 0.5, math.pi), (0.7, 0.7, 3.0), (0.5, 0.3, 1.0), (0.2, 0.3, math.pi), (0.6, 0.6, 0.0)]
MU = np.array([0.06, 0.3, 0.6, 0.95])


@pytest.mark.parametrize("stack", STACKS.values(), ids=STACKS)
def test_against_walks(stack):
    off = z_scores(*compared(stack, POINTS, MU, is_sheet=False))
    assert np.abs(off).max() < z_limit(np.size(off))


def test_light_beyond_the_first_reflection():
    """The bar: .2 % rms of the light that the base reflects several times, against walks of that noise."""
    stack, faint = (Stack([COAT, Medium(0.5, 0.1)], Retroreflector(r, 0.2)) for r in (0.9, 1e-6))
    single, dark = lamina.solve(faint), lamina.solve(Stack(stack.layers, lamina.Black()))

    def once(*point):
        without = dark.brdf(*point)[0]
        return without + 0.9e6 * (single.brdf(*point)[0] - without)

    points = [(0.8, 0.7, 0.3), (0.6, 0.6, 0.0), (0.9, 0.5, 2.0), (0.4, 0.6, 1.0)]
    beyond, off, noise = beyond_the_first(stack, once, points, 1 << 21)
    assert off < 0.002 * beyond + 1.5 * noise
    assert noise < 0.003 * beyond


@pytest.mark.parametrize("alpha", [0.03, 0.1, 0.5, 1.0])
def test_the_lobe_of_facets_seen_from_the_other_side(alpha):
    """Of a perfect metal, whose reflectance is 1 at all angles within 1e-5."""
    metal = lamina.solve(Stack([], Conductor(eta=1e-3, k=100.0, alpha=alpha)))
    sign = lamina.solve(Stack([], Retroreflector(1.0, alpha)))
    dphi = np.array([0.0, 0.5, 2.0, math.pi])
    found, expected = sign.grid("reflect", MU, MU, math.pi - dphi), metal.grid("reflect", MU, MU, dphi)
    assert np.allclose(found, expected, rtol=1e-3)
    assert np.allclose(sign.reflectance(MU), 1.0, atol=1e-9)


@pytest.mark.parametrize("stack", STACKS.values(), ids=STACKS)
def test_reciprocity(stack):
    values, others = exchanged(stack, MU)
    assert np.allclose(values, others, rtol=1e-4)
    assert np.all(values > 0.0)


def test_energy_under_a_coat():
    white = lamina.solve(Stack([COAT, Medium(1.0, 0.3)], Retroreflector(1.0, 0.1)))
    assert np.allclose(white.reflectance(MU), 1.0, atol=1e-4)


@pytest.mark.parametrize(("alpha", "mean", "worst"), [(0.03, 0.045, 0.16), (0.1, 0.055, 0.16)])
def test_lobes_about_the_viewer_fit_it(alpha, mean, worst):
    stack = Stack([COAT], Retroreflector(0.8, alpha))
    moving, standard = (lamina.bake(stack, "preview", basis=basis).report for basis in ("moving", "standard"))
    assert moving["fit_error"] < mean and moving["worst_slice"]["error"] < worst
    assert max(moving["albedo_error"], standard["albedo_error"]) < 1e-6
    assert moving["fit_error"] < standard["fit_error"] / 3.0


@pytest.mark.parametrize(("basis", "mean", "worst"), [("moving", 0.025, 0.1), ("standard", 0.11, 0.35)])
def test_a_backward_peak_fits_too(basis, mean, worst):
    soil = Stack([Medium(0.9, 20.0, HenyeyGreenstein(-0.9))], lamina.Lambert(0.1))
    report = lamina.bake(soil, "preview", basis=basis).report
    assert report["fit_error"] < mean and report["worst_slice"]["error"] < worst


def test_refusals():
    brushed = Stack([Interface(1.5, 0.1, alpha_v=0.3)], Retroreflector(0.5))
    with pytest.raises(StackError, match="^base.kind = 'retroreflector': must be another kind below anisotropic"):
        lamina.solve(brushed)
    with pytest.raises(StackError, match=r"^base.alpha = 0.01: must lie in \[0.03, 1\]"):
        Stack([], Retroreflector(0.5, 0.01))
