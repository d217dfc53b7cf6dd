# SPDX-License-Identifier: GPL-3.0-or-later
"""Structs that pass from Python to the core: facets of surfaces, targets of walks."""

import itertools

import pytest
from core_stacks import stack
from z_limit import z_limit

from lamina import _core

POOL = _core.ThreadPool(1)
FACETS = [(0.1, "ggx", True, True), (0.2, "ggx", True, True), (0.1, "beckmann", True, True), (0.1, "ggx", False, True),
          (0.1, "ggx", True, False)]
BOTTOM = (_core.Side.bottom, _core.Path.transmit)


def test_facets_are_equal_by_value():
    for one, other in itertools.product(FACETS, repeat=2):
        assert (_core.Facets(*one) == _core.Facets(*other)) == (one == other)
    assert len({_core.Facets(*one) for one in FACETS * 2}) == len(FACETS)
    assert _core.Facets(0.1) != (0.1, "ggx", True)


def test_facets_refuse_an_unknown_distribution():
    with pytest.raises(ValueError, match="distribution = 'phong': must be 'ggx' or 'beckmann'"):
        _core.Facets(0.1, "phong")


def test_surfaces_take_facets_by_name():
    facets = _core.Facets(0.3, "beckmann", correlated=False, compensate=False)
    coat = [_core.Interface(1.5, facets), _core.Medium(0.9, 1.0, "isotropic")]
    metal = _core.Base.conductor(0.2, 3.5, facets=facets)
    rough = _core.solve_roughly(_core.Stack(coat, metal), 1e-2, 16, POOL).fluxes(_core.Side.top, [0.5], POOL)
    smooth = [_core.Interface(1.5), _core.Medium(0.9, 1.0, "isotropic")]
    polished = _core.solve_roughly(_core.Stack(smooth, metal), 1e-2, 16, POOL).fluxes(_core.Side.top, [0.5], POOL)
    assert rough.mirrored[0] == 0.0 < polished.mirrored[0]


@pytest.mark.parametrize("target, expected", [
    (_core.WalkTarget(0.5, 0.6, 1.0), (_core.Side.top, _core.Path.reflect)),
    (_core.WalkTarget(0.5, 0.6, 1.0, *BOTTOM), BOTTOM),
])
def test_a_walk_estimates_its_target(target, expected):
    """The default is the BRDF from above."""
    medium = (0.9, 1.0, "hg", 0.5)
    total, squares, _, count, _ = _core.run_walk(_core.transfer_walk(stack([medium]), target), 3, 0, 8, POOL)
    mean = total / count
    exact = _core.solve_at(stack([medium]), 48, 1e-7, POOL, 1.0).points(*expected, [0.5], [0.6], [1.0], POOL)[0]
    assert abs(mean - exact) < z_limit(2) * ((squares / count - mean**2) / count) ** 0.5


def test_a_walk_of_flux_counts_all_directions():
    """In a conservative slab, reflectance plus transmittance is 1."""
    medium = (1.0, 1.0, "hg", 0.5)
    shares = []
    for path in (_core.Path.reflect, _core.Path.transmit):
        walk = _core.transfer_walk(stack([medium]), _core.WalkTarget(1.0, 0.6, 0.0, path=path, flux=True))
        total, squares, _, count, _ = _core.run_walk(walk, 3, 0, 8, POOL)
        shares.append((total / count, (squares / count - (total / count) ** 2) / count))
    error = (shares[0][1] + shares[1][1]) ** 0.5
    assert abs(shares[0][0] + shares[1][0] - 1.0) < z_limit(1) * error
