# SPDX-License-Identifier: GPL-3.0-or-later
"""Solves with each phase function: against PythonicDISORT, with moments that are integrated here, and against other
descriptions of the same medium."""

import math
import random

import disort_oracle
import numpy as np
import pytest
from drawn_kinds import drawn

import lamina
from lamina import (
    CornetteShanks,
    DoubleHenyeyGreenstein,
    Draine,
    HenyeyGreenstein,
    Isotropic,
    Medium,
    Mixture,
    Rayleigh,
    Stack,
    Tabulated,
    _core,
)
from lamina.kinds import phases

MU = np.array([0.05, 0.0713, 0.2, 0.45, 0.7, 0.95, 1.0])
DPHI = np.array([0.0, 0.3, 1.4, 2.6, math.pi])


def hg(g, x):
    return (1.0 - g * g) / (1.0 + g * g - 2.0 * g * x) ** 1.5


def draine(g, alpha, x):
    return (1.0 + alpha * x * x) * hg(g, x) / (1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0)


def integrated_moments(function, count):
    x, w = np.polynomial.legendre.leggauss(2000)
    weighted = 0.5 * w * function(x)
    chi = np.empty(count)
    before, now = np.zeros_like(x), np.ones_like(x)
    for order in range(count):
        chi[order] = weighted @ now
        before, now = now, ((2 * order + 1) * x * now - order * before) / (order + 1)
    return chi / chi[0]


DEGREES = np.radians(np.arange(0.0, 180.5, 0.5))
PHASES = [
    (DoubleHenyeyGreenstein(0.8, -0.5, 0.85), lambda x: 0.85 * hg(0.8, x) + 0.15 * hg(-0.5, x)),
    (Draine(0.6, 3.0), lambda x: draine(0.6, 3.0, x)),
    (CornetteShanks(0.7), lambda x: draine(0.7, 1.0, x)),
    (Tabulated(moments=integrated_moments(lambda x: draine(0.6, 1.0, x), 80)),
     lambda x: draine(0.6, 1.0, x)),
    (Tabulated(cosines=np.cos(DEGREES), values=7.0 * draine(0.6, 1.0, np.cos(DEGREES))),
     lambda x: draine(0.6, 1.0, x)),
    (Mixture([(0.4, HenyeyGreenstein(0.75)), (0.4, Draine(0.3, 2.0)), (0.2, Rayleigh())]),
     lambda x: 0.4 * hg(0.75, x) + 0.4 * draine(0.3, 2.0, x) + 0.15 * (1.0 + x * x)),
]
# The kinds without an entry above, with the core's own values as the function.
PHASES += [(one, _core.PhaseFunction(*one.in_channel(0)).evaluate) for one in (
    drawn(cls, random.Random(1)) for cls in phases.KINDS if cls not in {type(phase) for phase, _ in PHASES})]


@pytest.mark.parametrize("mu0", [0.2, 0.9])
@pytest.mark.parametrize("phase, function", PHASES, ids=lambda thing: getattr(thing, "kind", ""))
def test_against_disort(phase, function, mu0, monkeypatch):
    monkeypatch.setattr(disort_oracle, "moments", lambda _, count: integrated_moments(function, count))
    media = [(0.92, 1.5, phase)]
    truth = disort_oracle.pythonic(media, mu0, streams=80)
    solved = lamina.solve(disort_oracle.stack(media))
    assert solved.reflectance(mu0)[0] == pytest.approx(truth.reflectance, abs=1e-5)
    assert solved.transmittance(mu0, parts=True)[0][0] == pytest.approx(truth.diffuse, abs=1e-5)
    seen = truth.mu >= 0.05
    for dphi in (0.0, 1.0, math.pi):
        assert solved.brdf(truth.mu[seen], mu0, dphi)[:, 0] == pytest.approx(truth.brdf(dphi)[seen], rel=1e-3)
        assert solved.btdf(truth.mu[seen], mu0, dphi)[:, 0] == pytest.approx(truth.btdf(dphi)[seen], rel=1e-3)


HG = HenyeyGreenstein(0.7)
COSINES = np.cos(np.radians(np.arange(0.0, 180.25, 0.25)))


@pytest.mark.parametrize("one, other, rel", [
    (DoubleHenyeyGreenstein(0.7, -0.3, 1.0), HG, 1e-12),
    (Draine(0.7, 0.0), HG, 1e-12),
    (Draine(0.7, 1.0), CornetteShanks(0.7), 1e-10),
    (Draine(0.0, 1.0), Rayleigh(), 1e-12),
    (CornetteShanks(0.0), Rayleigh(), 1e-12),
    (Mixture([(1.0, HG)]), HG, 1e-12),
    (Mixture([(0.8, HG), (0.2, HenyeyGreenstein(-0.3))]), DoubleHenyeyGreenstein(0.7, -0.3, 0.8), 1e-10),
    (Mixture([(0.5, HG), (0.5, HG)]), HG, 1e-10),
    (Tabulated(moments=[1.0]), Isotropic(), 1e-10),
    (Tabulated(moments=[1.0, 0.0, 0.1]), Rayleigh(), 1e-7),
    (Tabulated(moments=0.7 ** np.arange(90)), HG, 1e-6),
    (Tabulated(cosines=COSINES, values=3.0 * (1.0 - 0.49) / (1.49 - 1.4 * COSINES) ** 1.5), HG, 1e-5),
], ids=lambda thing: getattr(thing, "kind", ""))
def test_other_words_for_the_same_matter(one, other, rel):
    def grids(phase):
        solved = lamina.solve(Stack([Medium(albedo=0.95, tau=1.0, phase=phase)], base=lamina.Lambert(0.3)))
        sheet = lamina.solve(Stack([Medium(albedo=0.95, tau=1.0, phase=phase)]))
        return solved.grid("reflect", MU, MU, DPHI), sheet.grid("transmit", MU, MU, DPHI)

    for found, expected in zip(grids(one), grids(other), strict=True):
        assert found == pytest.approx(expected, rel=rel)


@pytest.mark.parametrize("phase, _", PHASES, ids=lambda thing: getattr(thing, "kind", ""))
def test_nothing_is_lost_without_absorption(phase, _):
    solved = lamina.solve(Stack([Medium(albedo=1.0, tau=3.0, phase=phase)]))
    assert solved.reflectance(MU) + solved.transmittance(MU) == pytest.approx(np.ones((7, 1)), abs=1e-5)


def test_channels_are_solved_apart():
    tables = [[1.0, 0.2], [1.0], [1.0, 0.0, 0.1]]
    coloured = lamina.solve(Stack([Medium(albedo=0.9, tau=1.0, phase=Tabulated(moments=tables))]))
    found = coloured.grid("reflect", MU, MU, DPHI)
    for index, chi in enumerate(tables):
        alone = lamina.solve(Stack([Medium(albedo=0.9, tau=1.0, phase=Tabulated(moments=chi))]))
        assert np.array_equal(found[..., index], alone.grid("reflect", MU, MU, DPHI)[..., 0])


def test_a_half_space_and_a_varying_layer_take_every_phase():
    for phase, _ in PHASES:
        base = lamina.HalfSpace(0.9, phase)
        stack = Stack([Medium(albedo=0.8, tau=1.0, phase=phase, varying=True)], base)
        solved = lamina.solve(stack)
        thinner = solved.with_thickness(0, [0.25])
        direct = lamina.solve(Stack([Medium(albedo=0.8, tau=0.25, phase=phase)], base))
        assert thinner.grid("reflect", MU, MU, DPHI) == pytest.approx(direct.grid("reflect", MU, MU, DPHI), rel=1e-4)
