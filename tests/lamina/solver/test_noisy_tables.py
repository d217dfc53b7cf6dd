# SPDX-License-Identifier: GPL-3.0-or-later
"""Tabulated phase functions with noise but no peak: the solver against photon walks, which use the table itself, and
the message for too much noise."""

import math
import random

import numpy as np
import pytest
from z_limit import z_limit

import lamina
from lamina import Interface, Lambert, Medium, Stack, Tabulated
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


@pytest.mark.parametrize("stack", [
    Stack([Medium(albedo=0.9, tau=1.0, phase=noisy(181, 0.1, 4, g=0.6))]),
    Stack([Interface(1.5, 0.2), Medium(albedo=0.95, tau=0.7, phase=noisy(181, 0.1, 4, g=0.6))], Lambert(0.3)),
], ids=["alone", "below rough glass"])
def test_noise_of_a_peak_takes_few_nodes(stack):
    """Measured tables have errors in proportion to the values, so that the peak has most of the noise. Light scattered
    twice has the squares of the moments, of which noise has little."""
    solved, fine = lamina.solve(stack, "preview"), lamina.solve(stack, "preview", nodes=160)
    mu, dphi = np.array([0.05, 0.2, 0.5, 0.8, 1.0]), np.radians([0.0, 2.0, 5.0, 20.0, 100.0, 175.0, 180.0])
    for path in ("reflect", "transmit")[:1 if stack.base else 2]:
        found, exact = solved.grid(path, mu, mu, dphi), fine.grid(path, mu, mu, dphi)
        assert found == pytest.approx(exact, rel=tolerance_of("preview"), abs=1e-5)
    assert solved.nodes <= 32


def test_the_refusal_of_too_much_noise_tells_its_moments():
    stack = Stack([Medium(albedo=1.0, tau=1.0, phase=noisy(361, 0.3, 2))])
    with pytest.raises(lamina.SolveError, match=r"\d+ of its moments 320 to 512 are above 1e-05 and moment \d+ is "):
        lamina.solve(stack)


def test_the_refusal_of_a_peak_speaks_of_a_peak():
    with pytest.raises(lamina.SolveError, match="too sharp, its moment 320 is .*964"):
        lamina.solve(Stack([Medium(albedo=1.0, tau=1.0, phase=Tabulated(moments=[0.98**k for k in range(1000)]))]))
