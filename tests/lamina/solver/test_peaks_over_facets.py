# SPDX-License-Identifier: GPL-3.0-or-later
"""Media with peaked phase functions over wide facets: solved with few nodes, and against walks. The sum over rays,
which checks the solver, needs more rays there than between narrow lobes; with too few, such stacks were refused."""

import math

import pytest
from z_limit import z_limit

import lamina
from lamina import Conductor, HenyeyGreenstein, Interface, Medium, PrincipledBase, Stack

POINTS = [(0.6, 0.6, math.pi), (0.9, 0.9, 2.5), (0.3, 0.8, 1.0)]
# (anisotropy, optical thickness, roughness of the metal, most nodes)
OVER_METAL = [(0.8, 0.05, 1.0, 32), (0.9, 0.3, 0.5, 72), (0.94, 0.2, 0.5, 112), (0.95, 0.2, 1.0, 136)]
LIMIT = z_limit(len(OVER_METAL) * len(POINTS))


@pytest.mark.parametrize(("g", "tau", "alpha", "most"), OVER_METAL)
def test_a_dusty_metal_is_as_bright_as_in_walks(g, tau, alpha, most):
    stack = Stack([Medium(0.95, tau, HenyeyGreenstein(g))], Conductor(eta=0.2, k=3.0, alpha=alpha))
    solved = lamina.solve(stack, "final")
    assert solved.nodes <= most
    for point in POINTS:
        walk = lamina.estimate(stack, *point, "transfer", 1 << 18, seed=11)
        value = solved.brdf(*point)[0]
        assert abs(value - walk.value[0]) < LIMIT * walk.stderr[0] + 3e-4 * value


@pytest.mark.parametrize("roughness", [0.5, 0.7, 1.0])
@pytest.mark.parametrize("quality", ["preview", "final"])
def test_thin_snow_over_a_black_dielectric(roughness, quality):
    """A layer that Blender's artists put on a textured material: its dark part was refused."""
    stack = Stack([Medium(0.999986, 0.0311, HenyeyGreenstein(0.7))], PrincipledBase(0.0, roughness=roughness))
    assert lamina.solve(stack, quality).nodes <= 32


def test_below_a_wide_interface():
    stack = Stack([Interface(1.5, 0.5), Medium(0.9, 0.3, HenyeyGreenstein(0.9))], Conductor(0.2, 3.0, 0.5))
    solved = lamina.solve(stack, "final")
    for point in POINTS:
        walk = lamina.estimate(stack, *point, "transfer", 1 << 18, seed=12)
        value = solved.brdf(*point)[0]
        assert abs(value - walk.value[0]) < z_limit(len(POINTS)) * walk.stderr[0] + 3e-4 * value
