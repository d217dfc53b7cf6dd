# SPDX-License-Identifier: GPL-3.0-or-later
"""Two methods for a thick layer: its modes, for any thickness, and doubling, which joins halves."""

import math

import numpy as np
import pytest
from core_stacks import stack

from lamina import _core

POOL = _core.ThreadPool(1)
MU = np.array([0.05, 0.07, 0.2, 0.5, 0.9, 1.0])
DPHI = np.array([0.0, 0.4, 1.5, math.pi])
NODES = 48


def grids(media, lambert=None):
    solution = _core.solve_at(stack(media, lambert), NODES, 1e-7, POOL)
    return [solution.grid(side, path, MU, MU, DPHI, POOL)
            for side in (_core.Side.top, _core.Side.bottom) for path in (_core.Path.reflect, _core.Path.transmit)]


def at_nodes(media):
    """Fluxes at the nodes, where joining is exact algebra."""
    solution = _core.solve_at(stack(media), NODES, 1e-7, POOL)
    found = solution.fluxes(_core.Side.top, solution.node_cosines, POOL)
    return found.reflected, found.transmitted + found.direct


@pytest.mark.parametrize("albedo", [0.3, 1.0])
@pytest.mark.parametrize("tau", [1e-3, 0.1, 1.0, 16.0])
@pytest.mark.parametrize("kind, g", [("isotropic", 0.0), ("rayleigh", 0.0), ("hg", 0.6), ("hg", -0.5)])
class TestDoubling:
    def test_fluxes(self, albedo, tau, kind, g):
        whole = at_nodes([(albedo, tau, kind, g)])
        for count in (2, 5):
            joined = at_nodes([(albedo, tau / count, kind, g)] * count)
            for a, b in zip(whole, joined, strict=True):
                assert a == pytest.approx(b, abs=1e-12)

    def test_pointwise(self, albedo, tau, kind, g):
        for a, b in zip(grids([(albedo, tau, kind, g)]), grids([(albedo, tau / 2, kind, g)] * 2), strict=True):
            assert a == pytest.approx(b, rel=5e-5)


def test_any_order_of_joining():
    """Adding is associative: the core joins from the top; layers joined beforehand change the order of the joins."""
    a, b = (0.9, 0.5, "hg", 0.6), (0.7, 1.5, "rayleigh", 0.0)
    for split in ([a, a, b], [a, b, b], [a, b, b, b]):
        merged = [(m[0], m[1] * split.count(m), *m[2:]) for m in dict.fromkeys(split)]
        for one, other in zip(grids(split, 0.5), grids(merged, 0.5), strict=True):
            assert one == pytest.approx(other, rel=2e-5, abs=1e-13)


def test_a_stack_upside_down():
    media = [(0.9, 0.5, "hg", 0.6), (0.7, 1.5, "rayleigh", 0.0), (1.0, 0.01, "hg", -0.4)]
    top_r, top_t, bottom_r, bottom_t = grids(media)
    again_r, again_t, *_ = grids(media[::-1])
    assert bottom_r == pytest.approx(again_r, rel=1e-9) and bottom_t == pytest.approx(again_t, rel=1e-9)
    assert top_t == pytest.approx(bottom_t.swapaxes(0, 1), rel=1e-9)
    assert not np.allclose(top_r, bottom_r, rtol=1e-2)


def test_another_thickness_shares_the_modes():
    thick = stack([(0.9, 5.0, "hg", 0.6), (0.99, 1.0, "isotropic")], 0.3)
    first = _core.solve_at(thick, 32, 1e-7, POOL)
    before = first.grid(_core.Side.top, _core.Path.reflect, MU, MU, DPHI, POOL)
    for tau in (0.0, 1e-3, 1.0, 1e6, math.inf):
        other = first.with_thickness(0, tau, POOL)
        thinner = stack([(0.9, tau, "hg", 0.6), (0.99, 1.0, "isotropic")], 0.3)
        fresh = _core.solve_at(thinner, 32, 1e-7, POOL)
        values = [s.grid(_core.Side.top, _core.Path.reflect, MU, MU, DPHI, POOL) for s in (other, fresh)]
        assert values[0] == pytest.approx(values[1], rel=1e-9)
    after = first.grid(_core.Side.top, _core.Path.reflect, MU, MU, DPHI, POOL)
    assert before.tobytes() == after.tobytes()
    with pytest.raises((IndexError, RuntimeError)):
        first.with_thickness(2, 1.0, POOL)


def test_checks_see_what_is_too_coarse():
    """Eight nodes cannot resolve a thin layer: the error estimate, relative to all light of the layer, exceeds the
    tolerance, and falls with more nodes."""
    thin = stack([(0.9, 0.01, "hg", 0.8)])
    found = [_core.solve_at(thin, n, 1e-5, POOL).checks.resolution for n in (8, 16, 32, 64)]
    assert found[0] > 1e-3 > 1e-4 > found[3] and sorted(found, reverse=True) == found
