# SPDX-License-Identifier: GPL-3.0-or-later
"""Rough boundaries between nearly equal indices, where facets hardly turn the light."""

import numpy as np
import pytest
import smith_walk
from z_limit import z_limit

import lamina
from lamina import Black, HenyeyGreenstein, Interface, Medium, Stack

MU = np.array([0.05, 0.1, 0.3, 0.6, 0.95])
DUST = Medium(albedo=0.9, tau=0.3, phase=HenyeyGreenstein(0.8))
FACETS = pytest.mark.parametrize("facets", [
    {"alpha": 0.5}, {"alpha": 0.1}, {"alpha": 0.5, "distribution": "beckmann"}, {"alpha": 0.5, "correlated": False}],
    ids=str)


@FACETS
def test_the_boundary_vanishes_with_the_difference_of_indices(facets):
    matched = lamina.solve(Stack([DUST], Black()))
    nearly = lamina.solve(Stack([Interface(1.00001, **facets), DUST], Black()))
    assert nearly.reflectance(MU) == pytest.approx(matched.reflectance(MU), rel=5e-3)
    assert nearly.brdf(0.3, 0.3, np.pi) == pytest.approx(matched.brdf(0.3, 0.3, np.pi), rel=5e-3)


@FACETS
def test_a_sheet_is_reciprocal_and_keeps_its_energy(facets):
    sheet = lamina.solve(Stack([Interface(1.05, **facets), Medium(albedo=1.0, tau=0.5), Interface(1.0, **facets)]))
    down, up = sheet.btdf(0.3, 0.8, 2.0), sheet.btdf(0.8, 0.3, 2.0, side="bottom")
    assert down == pytest.approx(up, rel=1e-5)
    assert sheet.absorption(MU) == pytest.approx(0.0, abs=1e-5)


@FACETS
def test_walks_follow_the_same_law(facets):
    stack = Stack([Interface(1.05, **facets), DUST], Black())
    found = lamina.solve(stack).reflectance(MU)[:, 0]
    walked = [lamina.estimate(stack, None, mu, samples=100_000, seed=seed, threads=2) for seed, mu in enumerate(MU)]
    scores = [(one.value[0] - wanted) / one.stderr[0] for one, wanted in zip(walked, found, strict=True)]
    assert np.abs(scores).max() < z_limit(4 * len(scores))


@pytest.mark.parametrize("ior", [1.01, 1.05, 1.2, 1.5])
@pytest.mark.parametrize("alpha", [0.2, 0.5])
def test_facets_reflect_like_those_that_scatter_repeatedly(alpha, ior):
    """Two models: repeated scattering is exact in the walk, and the compensation approximates it."""
    solved = lamina.solve(Stack([Interface(ior, alpha)], Black()))
    for seed, mu in enumerate((0.1, 0.3, 0.8)):
        value, sigma = smith_walk.reflectance(mu, ior=ior, alpha=alpha, paths=40_000, seed=seed)
        assert abs(solved.reflectance(mu)[0] - value) < 0.011 + 2.0 * sigma
