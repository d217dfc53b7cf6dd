# SPDX-License-Identifier: GPL-3.0-or-later
"""Tabulated phase functions with noise but no peak: the solver against photon walks, which use the table itself, and
the message for too much noise."""

import math
import random

import pytest
from z_limit import z_limit

import lamina
from lamina import Medium, Stack, Tabulated
from lamina.solver.core_calls import tolerance_of

POINTS = [(0.5, 0.5, 0.0, "transmit"), (0.8, 0.4, 1.3, "reflect"), (0.9, 0.6, math.pi, "reflect"),
          (0.3, 0.7, 0.4, "transmit")]
QUALITIES = ("preview", "final")


def noisy(count, noise, seed, g=0.3):
    chance = random.Random(seed)
    cosines = [math.cos(math.pi * k / (count - 1)) for k in range(count)]
    values = [(1.0 + g * g - 2.0 * g * x) ** -1.5 * max(0.0, 1.0 + noise * chance.gauss(0.0, 1.0)) for x in cosines]
    return Tabulated(cosines=cosines, values=values)


TABLES = [noisy(181, 0.1, 1), noisy(37, 0.3, 2), noisy(91, 0.2, 3, g=-0.2)]
LIMIT = z_limit(len(TABLES) * len(POINTS) * len(QUALITIES))


@pytest.mark.parametrize("quality", QUALITIES)
@pytest.mark.parametrize("number", range(len(TABLES)))
def test_noise_is_resolved_and_right(number, quality):
    stack = Stack([Medium(albedo=0.95, tau=1.5, phase=TABLES[number])])
    solved = lamina.solve(stack, quality)
    for mu_o, mu_i, dphi, path in POINTS:
        value = (solved.brdf if path == "reflect" else solved.btdf)(mu_o, mu_i, dphi)[0]
        walk = lamina.estimate(stack, mu_o, mu_i, dphi, "transfer", 1 << 17, seed=number, path=path)
        assert abs(value - walk.value[0]) < LIMIT * walk.stderr[0] + tolerance_of(quality) * value


def test_the_refusal_of_too_much_noise_tells_its_moments():
    stack = Stack([Medium(albedo=1.0, tau=1.0, phase=noisy(361, 0.3, 2))])
    with pytest.raises(lamina.SolveError, match=r"\d+ of its moments 320 to 512 are above 1e-05 and moment \d+ is "):
        lamina.solve(stack)


def test_the_refusal_of_a_peak_speaks_of_a_peak():
    with pytest.raises(lamina.SolveError, match="too sharp, its moment 320 is .*964"):
        lamina.solve(Stack([Medium(albedo=1.0, tau=1.0, phase=Tabulated(moments=[0.98**k for k in range(1000)]))]))
