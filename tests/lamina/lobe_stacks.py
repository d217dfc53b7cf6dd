# SPDX-License-Identifier: GPL-3.0-or-later
"""Random lacquered, frosted and coated stacks, in which light of rough boundaries' lobes meets mirrors and lobes."""

import math
import random

from lamina import Conductor, HenyeyGreenstein, Interface, Lambert, Medium, Stack
from lamina.walks.estimate import Query

METALS = [(0.2, 3.0), (0.2, 3.9), (1.3, 7.5), (2.9, 3.1), (0.06, 4.0)]


def width(chance):
    """Alpha from .03 to .5, evenly in its logarithm."""
    return math.exp(chance.uniform(math.log(0.03), math.log(0.5)))


def maybe_rough(chance, odds=0.5):
    return width(chance) if chance.random() < odds else 0.0


def boundary(chance, ior, alpha):
    distribution = chance.choice(["ggx", "ggx", "beckmann"])
    return Interface(ior, alpha, distribution, compensate=chance.random() < 0.5)


def metal(chance, alpha):
    return Conductor(*chance.choice(METALS), alpha, chance.choice(["ggx", "ggx", "beckmann"]),
                     compensate=chance.random() < 0.5)


def medium(chance):
    tau = math.exp(chance.uniform(math.log(0.02), math.log(2.0)))
    if chance.random() < 0.4:
        return Medium(albedo=0.0, tau=tau)
    return Medium(albedo=chance.uniform(0.2, 1.0), tau=tau, phase=HenyeyGreenstein(chance.uniform(-0.3, 0.7)))


def between(chance):
    return [medium(chance)] if chance.random() < 0.5 else []


def index(chance):
    return round(chance.uniform(1.3, 1.7), 3)


def lacquered(chance):
    """A coat over metal, at least one of them rough."""
    coat = maybe_rough(chance, 0.4)
    layers = [boundary(chance, index(chance), coat), *between(chance)]
    if chance.random() < 0.25:
        layers += [boundary(chance, index(chance), maybe_rough(chance)), *between(chance)]
    return Stack(layers, metal(chance, width(chance) if coat == 0.0 else maybe_rough(chance, 0.6)))


def frosted(chance):
    """A sheet of glass that is rough on one side or on both."""
    sides = chance.choice([(width(chance), 0.0), (0.0, width(chance)), (width(chance), width(chance))])
    return Stack([boundary(chance, index(chance), sides[0]), *between(chance), boundary(chance, 1.0, sides[1])])


def coated(chance):
    """A rough or smooth coat over a scattering ground, with an index step between for some."""
    layers = [boundary(chance, index(chance), width(chance)), medium(chance)]
    if chance.random() < 0.5:
        layers += [boundary(chance, index(chance), maybe_rough(chance)), *between(chance)]
    return Stack(layers, Lambert(chance.random()))


def case(number, seed=0):
    """(stack, query): one of three kinds in turn, seen in a lobe, on its flank or away from it."""
    chance = random.Random(10_000 * seed + number)
    stack = [lacquered, frosted, coated][number % 3](chance)
    sheet = stack.base is None
    side = chance.choice(["top", "bottom"]) if sheet else "top"
    path = chance.choice(["reflect", "transmit"]) if sheet else "reflect"
    mu_i = chance.uniform(0.05, 1.0)
    if chance.random() < 0.5:
        mu_o, dphi = chance.uniform(0.05, 1.0), chance.uniform(0.0, math.pi)
    else:
        mu_o = min(1.0, max(0.05, mu_i + chance.gauss(0.0, 0.1)))
        dphi = min(math.pi, abs(chance.gauss(0.0, 0.3)))
    return stack, Query(mu_o, mu_i, dphi, side, path)
