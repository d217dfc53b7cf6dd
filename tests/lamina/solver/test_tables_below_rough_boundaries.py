# SPDX-License-Identifier: GPL-3.0-or-later
"""Bows and glories of tabulated phase functions below rough boundaries: the solver against photon walks, which use the
table itself, and the check of returned values, which sums over rays."""

import math

import numpy as np
import pytest
from z_limit import z_limit

import lamina
from lamina import Conductor, HalfSpace, Interface, Medium, Stack, Tabulated, _core
from lamina.solver.core_calls import tolerance_of
from lamina.solver.core_stack import core_stack

QUALITIES = ("preview", "final")


def core(stack):
    return _core.Stack(*core_stack(stack, 0, False)[1:])


def with_bow(width):
    """A table with a bow at 142 degrees and a glory at 180, this many degrees wide."""
    degrees = [0.25 * k for k in range(721)]

    def hump(angle, center):
        return math.exp(-0.5 * ((angle - center) / (0.5 * width)) ** 2)

    values = [0.2 + 4.8 * math.exp(3.0 * math.cos(math.radians(a)) - 3.0) + 0.5 * hump(a, 142.0) + 0.8 * hump(a, 180.0)
              for a in degrees]
    cosines = [math.cos(math.radians(a)) for a in degrees]
    return Tabulated(cosines=[-1.0, *cosines[-2:0:-1], 1.0], values=values[::-1])


STACKS = {
    "deep": Stack([Interface(1.33, 0.05), HalfSpace(0.5, with_bow(3.0))]),
    "glory of 1.5 degrees": Stack([Interface(1.33, 0.05), HalfSpace(0.5, with_bow(1.5))]),
    "sheet": Stack([Interface(1.33, 0.05), Medium(0.8, 0.5, with_bow(2.0)), Interface(1.0, 0.1)]),
    "metal": Stack([Interface(1.4), Medium(0.8, 0.2, with_bow(2.0))], base=Conductor(eta=0.2, k=3.0, alpha=0.1)),
}
POINTS = [(0.9, 0.9, math.pi), (0.9, 0.6, 2.5), (0.5, 0.7, 1.9)]
LIMIT = z_limit(len(STACKS) * len(POINTS) * len(QUALITIES))


@pytest.mark.parametrize("name", STACKS)
def test_bows_are_as_bright_as_in_walks(name):
    walks = [lamina.estimate(STACKS[name], *point, "transfer", 1 << 18, seed=7) for point in POINTS]
    for quality in QUALITIES:
        solved = lamina.solve(STACKS[name], quality)
        for point, walk in zip(POINTS, walks, strict=True):
            value = solved.brdf(*point)[0]
            assert abs(value - walk.value[0]) < LIMIT * walk.stderr[0] + 0.3 * tolerance_of(quality) * value


def test_slices_of_a_bake_hold_the_bow():
    stack = STACKS["glory of 1.5 degrees"]
    pool = _core.ThreadPool(1)
    solution = _core.solve(core(stack), tolerance_of("preview"), pool)
    sight = (_core.Side.top, _core.Path.reflect)
    values = _core.slices([solution], [sight], np.array([0.9]), np.array([0.9]), np.array([math.pi]), pool)[0]
    value = lamina.solve(stack, "preview").grid("reflect", [0.9], [0.9], [math.pi])
    assert np.ravel(values)[0] == pytest.approx(0.9 * value.item(), rel=1e-9)


def test_the_check_of_returned_values_sees_a_glory_that_moments_cannot_hold():
    # 512 moments do not represent a glory of a tenth of a degree.
    angles = [0.0, 60.0, 120.0, 179.0, 179.8, 179.9, 179.95, 180.0]
    cosines = [math.cos(math.radians(a)) for a in angles]
    table = Tabulated(cosines=[-1.0, *cosines[-2:0:-1], 1.0], values=[60.0, 20.0, 5.0, 1.0, 1.0, 1.0, 1.0, 1.0])
    stack = Stack([Interface(1.1, 0.01), HalfSpace(0.5, table)])
    checks = _core.solve_at(core(stack), 32, 1e-3, _core.ThreadPool(1)).checks
    assert checks.resolution > 0.1
