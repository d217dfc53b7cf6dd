# SPDX-License-Identifier: GPL-3.0-or-later
"""The walks of the scattering equation against the solver and the differential form, by Z-score."""

import math

import numpy as np
import pytest
from core_stacks import stack
from z_limit import z_limit

from lamina import _core

POOL = _core.ThreadPool(1)
BLOCK = 4096

# (albedo, tau, kind, g), (mu_o, mu_i, dphi), walk, blocks. Every walk by name.
CASES = [
    ((0.5, 0.1, "isotropic", 0.0), (1.0, 1.0, 0.0), "isotropic", 8),
    ((0.9, 2.0, "isotropic", 0.0), (0.5, 0.3, 1.0), "isotropic", 8),
    ((1.0, 10.0, "isotropic", 0.0), (0.05, 0.7, 2.0), "isotropic", 8),
    ((0.9, 1.0, "isotropic", 0.0), (1.0, 0.5, 0.0), "guided-16", 8),
    ((0.5, 0.1, "hg", 0.8), (1.0, 1.0, 0.0), "guided-8", 12),
    ((0.9, 2.0, "hg", 0.8), (0.5, 0.5, math.pi / 2), "guided-16", 12),
    ((0.9, 1.0, "hg", 0.8), (0.1, 0.7, 0.5), "guided-32", 8),
    ((1.0, 1.0, "hg", -0.3), (0.6, 0.8, 2.5), "guided-8", 12),
    ((0.99, 5.0, "hg", 0.5), (0.5, 0.9, 3.0), "guided-16", 8),
    ((0.9, 2.0, "rayleigh", 0.0), (0.8, 0.2, 0.3), "guided-8", 8),
    ((0.5, 0.3, "hg", 0.5), (0.5, 0.7, 1.0), "plain", 40),
    ((1.0, 5.0, "hg", -0.3), (0.3, 1.0, 0.0), "transfer", 20),
    ((0.9, 0.5, "hg", 0.8), (0.7, 0.4, 1.5), "auto", 12),
    ((0.5, 0.1, "hg", 0.8), (1.0, 1.0, 0.0), "residual-8", 12),
    ((0.9, 1.0, "hg", 0.8), (0.1, 0.7, 0.5), "residual-16", 16),
    ((0.9, 2.0, "hg", 0.8), (0.5, 0.5, math.pi / 2), "residual-32", 12),
    ((0.99, 5.0, "hg", 0.5), (0.5, 0.9, 3.0), "residual-16", 8),
    ((1.0, 1.0, "hg", -0.3), (0.6, 0.8, 2.5), "residual-8", 12),
    ((0.9, 2.0, "rayleigh", 0.0), (0.8, 0.2, 0.3), "residual-8", 12),
    ((0.9, 1.0, "isotropic", 0.0), (1.0, 0.5, 0.0), "residual-16", 12),
    ((0.9, 2.0, "hg", 0.8), (0.5, 0.5, 0.0), "transfer", 60),
]


def estimate(medium, directions, walk, blocks, seed=11, first=0):
    made = _core.ScatteringWalk(medium, *directions, walk, seed)
    total, squares, largest, count, events = _core.run_walk(made.walk, seed, first, first + blocks, POOL)
    mean = total / count
    return mean, math.sqrt(max(squares / count - mean * mean, 0.0) / (count - 1)), largest, events / count


def homogeneous(albedo, tau, kind, g):
    return _core.GradedMedium.homogeneous(albedo, tau, kind, *([g] if kind == "hg" else []))


def solved(medium, directions, nodes=64):
    mu_o, mu_i, dphi = (np.array([x]) for x in directions)
    fine = _core.solve_at(stack([medium]), nodes, 1e-7, POOL, medium[1])
    return float(fine.points(_core.Side.top, _core.Path.reflect, mu_o, mu_i, dphi, POOL)[0])


@pytest.mark.parametrize("medium, directions, walk, blocks", CASES)
def test_unbiased(medium, directions, walk, blocks):
    mean, error, _, _ = estimate(homogeneous(*medium), directions, walk, blocks)
    truth = solved(medium, directions)
    # The solver's own error joins the walk's: some walks err by 1e-5.
    assert abs(mean - truth) < z_limit(len(CASES)) * math.hypot(error, 2e-5 * truth)


HARD = [
    ((1.0, 50.0, "isotropic", 0.0), (0.5, 0.5, 1.0), "isotropic", 16),
    ((0.9, 1.0, "hg", 0.9), (1.0, 0.6, 0.0), "guided-16", 24),
    ((0.95, 1.0, "hg", 0.6), (0.05, 0.05, 0.5), "guided-16", 16),
]


@pytest.mark.parametrize("medium, directions, walk, blocks", HARD, ids=["thick", "peaked", "grazing"])
def test_unbiased_where_it_is_hard(medium, directions, walk, blocks):
    mean, error, _, _ = estimate(homogeneous(*medium), directions, walk, blocks, seed=3)
    truth = solved(medium, directions, 96)
    assert abs(mean - truth) < z_limit(len(HARD)) * math.hypot(error, 2e-5 * truth)
    assert error < 0.02 * truth


GUIDED_TRANSFER = [
    ((0.5, 0.1, "hg", 0.8), (1.0, 1.0, 0.0)),
    ((0.9, 2.0, "hg", 0.8), (0.5, 0.5, math.pi / 2)),
    ((0.9, 1.0, "hg", 0.8), (0.1, 0.7, 0.5)),
    ((1.0, 1.0, "hg", -0.3), (0.6, 0.8, 2.5)),
    ((0.99, 5.0, "hg", 0.5), (0.5, 0.9, 3.0)),
    ((0.9, 1.0, "isotropic", 0.0), (1.0, 0.5, 0.0)),
    ((0.9, 2.0, "rayleigh", 0.0), (0.8, 0.2, 0.3)),
    ((0.99, 10.0, "hg", 0.8), (0.05, 1.0, 0.0)),
    ((0.9, 1.0, "hg", 0.9), (1.0, 0.6, 0.0)),
]


@pytest.mark.parametrize("medium, directions", GUIDED_TRANSFER)
def test_the_guided_transfer_walk_is_unbiased(medium, directions):
    walk = _core.guided_transfer_walk(homogeneous(*medium), *directions)
    total, squares, _, count, _ = _core.run_walk(walk, 4, 0, 48, POOL)
    mean = total / count
    error = math.sqrt((squares / count - mean * mean) / (count - 1))
    truth = solved(medium, directions)
    assert abs(mean - truth) < z_limit(len(GUIDED_TRANSFER)) * math.hypot(error, 2e-5 * truth)
    assert error < 0.02 * truth


# A million samples each, where large weights would show.
LONG = [
    ((0.5, 0.5, "hg", 0.8), (1.0, 0.1, 0.0)),
    ((0.9, 1.0, "hg", 0.8), (0.1, 0.7, 0.5)),
    ((0.9, 0.5, "hg", 0.8), (0.5, 0.5, 0.0)),
    ((0.9, 2.0, "hg", 0.8), (1.0, 1.0, 0.0)),
    ((0.99, 0.5, "hg", 0.8), (0.5, 0.5, math.pi)),
    ((1.0, 1.0, "hg", -0.3), (0.5, 0.5, math.pi / 2)),
]


@pytest.mark.parametrize("medium, directions", LONG)
def test_no_tail_hides(medium, directions):
    """The estimate of a million samples; none of them may have a large share of the variance."""
    mean, error, largest, _ = estimate(homogeneous(*medium), directions, "residual-8", 256, seed=21)
    truth = solved(medium, directions)
    assert abs(mean - truth) < z_limit(len(LONG)) * math.hypot(error, 2e-5 * truth)
    count = 256 * BLOCK
    assert (largest / count) ** 2 < 0.1 * error**2


def test_the_value_of_the_equation():
    """Isotropic, albedo .9, tau 1, mu 1, mu0 .5: S = .596302."""
    mean, error, _, _ = estimate(homogeneous(0.9, 1.0, "isotropic", 0.0), (1.0, 0.5, 0.0), "isotropic", 40)
    scale = 4.0 * math.pi * 0.5
    assert abs(scale * mean - 0.596302) < z_limit(1) * math.hypot(scale * error, 3e-7)
    assert scale * error < 2e-5


GRADED = [
    [(0.0, 0.95, ("isotropic",)), (0.7, 0.3, ("isotropic",)), (2.0, 0.9, ("isotropic",))],
    [(0.0, 0.9, ("hg", 0.6)), (0.5, 0.5, ("hg", -0.2)), (1.5, 1.0, ("hg", 0.3))],
]


@pytest.mark.parametrize("knots", GRADED, ids=["albedo", "phase"])
@pytest.mark.parametrize("walk, blocks", [("auto", 8), ("guided-16", 8), ("transfer", 40)])
def test_media_that_vary_with_depth(knots, walk, blocks):
    medium = _core.GradedMedium(knots)
    mu_o, mu_i, dphi = 0.6, 0.35, 1.2
    mean, error, _, _ = estimate(medium, (mu_o, mu_i, dphi), walk, blocks)
    truth = _core.scattering_ode(medium, [mu_o, mu_i], [dphi], POOL)["brdf"][0, 1, 0]
    assert abs(mean - truth) < z_limit(6) * math.hypot(error, 2e-5 * truth)


@pytest.mark.parametrize("tau", [1e-9, 1e-4])
@pytest.mark.parametrize("kind, g, walk", [("isotropic", 0.0, "isotropic"), ("hg", 0.8, "guided-8"),
                                           ("hg", 0.8, "transfer-guided")])
def test_thin_slabs(tau, kind, g, walk):
    """No digits are lost where exponentials differ by less than their rounding."""
    medium, directions = (0.9, tau, kind, g), (0.7, 0.4, 1.0)
    mean, error, _, _ = estimate(homogeneous(*medium), directions, walk, 2)
    truth = solved(medium, directions)
    assert abs(mean - truth) < z_limit(6) * math.hypot(error, 1e-6 * truth)


def test_guided_walks_beat_the_plain_transfer_walk():
    """By variance and events alone, with limits at a tenth of measured ratios: a broken guide would fail."""
    directions = (0.5, 0.5, math.pi / 2)
    for medium, walk, gain in [((0.9, 2.0, "hg", 0.8), "transfer-guided", 10.0),
                               ((0.9, 2.0, "isotropic", 0.0), "isotropic", 500.0),
                               ((0.9, 0.5, "hg", 0.8), "guided-16", 10.0),
                               ((0.9, 0.5, "hg", 0.8), "residual-16", 10.0)]:
        guided = estimate(homogeneous(*medium), directions, walk, 4)
        plain = _core.transfer_walk(stack([medium]), _core.WalkTarget(*directions),
                                    next_event=_core.NextEvent.at_collision)
        total, squares, _, count, _ = _core.run_walk(plain, 11, 0, 20, POOL)
        variance = (squares / count - (total / count) ** 2) / (count - 1)
        assert variance / guided[1] ** 2 * 20.0 / 4.0 > gain


def test_the_pilot_falls_back_to_transfer_walks():
    thick = homogeneous(1.0, 50.0, "hg", 0.8)
    assert _core.ScatteringWalk(thick, 1.0, 1.0, 0.0, "auto", 1).name.startswith("transfer")
    bright = homogeneous(0.99, 10.0, "hg", 0.8)
    assert _core.ScatteringWalk(bright, 0.5, 0.5, 0.0, "auto", 1).name == "transfer-guided"
    thin = _core.ScatteringWalk(homogeneous(0.5, 0.1, "hg", 0.8), 1.0, 1.0, 0.0, "auto", 1)
    assert thin.name != "transfer" and thin.pilot_samples > 0


def test_the_fallback_is_the_transfer_walk_itself():
    one = (0.9, 2.0, "hg", 0.8)
    plain = _core.transfer_walk(stack([one]), _core.WalkTarget(0.5, 0.4, 1.0))
    same = _core.ScatteringWalk(homogeneous(*one), 0.5, 0.4, 1.0, "transfer", 0).walk
    assert _core.run_walk(plain, 5, 0, 2, POOL) == _core.run_walk(same, 5, 0, 2, POOL)


def test_the_residual_walk_knows_homogeneous_media_over_nothing():
    for medium in (_core.GradedMedium(GRADED[0]), homogeneous(0.9, 2.0, "hg", 0.8).over(0.5)):
        with pytest.raises(ValueError, match="must be homogeneous, over nothing"):
            _core.ScatteringWalk(medium, 0.5, 0.4, 1.0, "residual-8", 0)


def test_blocks_and_threads():
    walk = _core.ScatteringWalk(homogeneous(0.9, 2.0, "hg", 0.8), 0.5, 0.5, 1.0, "guided-8", 0)
    one = _core.run_walk(walk.walk, 5, 0, 4, _core.ThreadPool(1))
    assert one == _core.run_walk(walk.walk, 5, 0, 4, _core.ThreadPool(2))
    parts = [_core.run_walk(walk.walk, 5, k, k + 1, POOL) for k in range(4)]
    assert one[0] == sum(part[0] for part in parts) and one[3] == 4 * BLOCK


@pytest.mark.parametrize("knots, words", [
    ([(0.0, 0.5, ("isotropic",))], "must be at least two"),
    ([(0.1, 0.5, ("isotropic",)), (1.0, 0.5, ("isotropic",))], "the first at tau = 0"),
    ([(0.0, 0.5, ("isotropic",)), (0.0, 0.5, ("isotropic",))], "must ascend"),
])
def test_knots_that_are_none(knots, words):
    with pytest.raises(ValueError, match=words):
        _core.GradedMedium(knots)


def test_a_walk_that_is_none():
    with pytest.raises(ValueError, match="walk = 'swift': must be one of auto"):
        _core.ScatteringWalk(homogeneous(0.9, 1.0, "isotropic", 0.0), 1.0, 1.0, 0.0, "swift", 0)
