# SPDX-License-Identifier: GPL-3.0-or-later
"""Forty random stacks and directions on which all five methods are compared: transfer, adding and scattering walks, the
differential form, and the solver. Walks by Z-score at a family-wise level of 1 % (Sidak, over all comparisons)."""

import math
import random
from functools import cache

import numpy as np
import pytest
from drawn_kinds import of_all
from z_limit import z_limit

import lamina
from lamina import Black, Knot, Lambert, Medium, Stack, _core
from lamina.kinds import phases
from lamina.solver.core_calls import tolerance_of
from lamina.solver.core_stack import core_stack
from lamina.walks.estimate import Query

COUNT = 40
METHODS = {"transfer": 1 << 14, "scattering": 1 << 13, "adding": 1 << 13}
LIMIT = z_limit(COUNT * len(METHODS))
ODE_ERROR = 2e-5
POOL = _core.ThreadPool(1)


def phase(chance):
    special = {
        lamina.Isotropic: lamina.Isotropic,
        lamina.Rayleigh: lamina.Rayleigh,
        lamina.HenyeyGreenstein: lambda: lamina.HenyeyGreenstein(chance.uniform(-0.4, 0.7)),
        lamina.DoubleHenyeyGreenstein: lambda: lamina.DoubleHenyeyGreenstein(
            chance.uniform(0.2, 0.7), chance.uniform(-0.5, 0.0), chance.random()),
        lamina.Draine: lambda: lamina.Draine(chance.uniform(0.0, 0.6), chance.uniform(0.0, 2.0)),
        lamina.CornetteShanks: lambda: lamina.CornetteShanks(chance.uniform(0.0, 0.6)),
        lamina.Tabulated: lambda: lamina.Tabulated(
            moments=[1.0, chance.uniform(-0.2, 0.3), chance.uniform(0.0, 0.1)]),
        lamina.Mixture: lambda: lamina.Mixture([(0.6, lamina.HenyeyGreenstein(0.6)), (0.4, lamina.Rayleigh())]),
    }
    kinds = of_all(phases.KINDS, special, chance)
    return chance.choice(kinds)()


def medium(chance):
    tau = math.exp(chance.uniform(math.log(0.05), math.log(4.0)))
    if chance.random() < 0.5:
        return Medium(albedo=chance.uniform(0.3, 1.0), tau=tau, phase=phase(chance))
    depths = [0.0, *([chance.uniform(0.2, 0.8)] if chance.random() < 0.4 else []), 1.0]
    knots = [Knot(depth, albedo=chance.uniform(0.2, 1.0), phase=phase(chance)) for depth in depths]
    return Medium(tau=tau, profile=knots)


def case(number):
    chance = random.Random(1000 + number)
    layers = [medium(chance) for _ in range(chance.choice([1, 1, 1, 2, 2, 3]))]
    base = chance.choice([None, Black(), Lambert(chance.random())])
    mu_o, mu_i = chance.uniform(0.05, 1.0), chance.uniform(0.05, 1.0)
    return Stack(layers, base), Query(mu_o, mu_i, chance.uniform(0.0, math.pi))


def joined_media(stack):
    _, layers, base = core_stack(stack, 0)
    return _core.joined_media(_core.Stack(layers, base))


@cache
def by_ode(number):
    stack, query = case(number)
    mu = np.array([query.mu_o, query.mu_i])
    found = _core.scattering_ode(joined_media(stack), mu, [query.dphi], POOL, nodes=24, tolerance=1e-7)
    return found["brdf"][0, 1, 0]


@pytest.mark.parametrize("number", range(COUNT))
def test_solver_and_differential_form(number):
    stack, query = case(number)
    solved = lamina.solve(stack, threads=1).brdf(query.mu_o, query.mu_i, query.dphi)[0]
    assert solved == pytest.approx(by_ode(number), rel=tolerance_of("final"))


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("number", range(COUNT))
def test_walks(number, method):
    stack, query = case(number)
    truth = by_ode(number)
    found = lamina.estimate(stack, query.mu_o, query.mu_i, query.dphi, method, METHODS[method], seed=1, threads=1)
    off = (ODE_ERROR + found.table_error) * truth
    assert abs(found.value[0] - truth) / math.hypot(found.stderr[0], off) < LIMIT


def test_an_added_phase_function_takes_part(monkeypatch):
    class Added(lamina.HenyeyGreenstein):
        pass

    monkeypatch.setattr(phases, "KINDS", (*phases.KINDS, Added))
    chance = random.Random(1)
    assert {type(phase(chance)) for _ in range(200)} == set(phases.KINDS) | {lamina.Tabulated, lamina.Mixture}
