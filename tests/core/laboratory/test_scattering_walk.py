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
    ((0.5, 0.1, "hg", 0.8), (1.0, 1.0, 0.0), "by terms", 40),
    ((0.5, 0.3, "hg", 0.5), (0.5, 0.7, 1.0), "by terms", 40),
    ((0.9, 0.5, "hg", -0.3), (0.6, 0.8, 2.5), "by terms", 40),
    ((0.9, 1.0, "isotropic", 0.0), (1.0, 0.5, 0.0), "by terms", 40),
    ((0.5, 0.1, "hg", 0.8), (1.0, 1.0, 0.0), "transfer, guided", 48),
    ((0.9, 2.0, "hg", 0.8), (0.5, 0.5, math.pi / 2), "transfer, guided", 48),
    ((0.9, 1.0, "hg", 0.8), (0.1, 0.7, 0.5), "transfer, guided", 48),
    ((1.0, 1.0, "hg", -0.3), (0.6, 0.8, 2.5), "transfer, guided", 48),
    ((0.99, 5.0, "hg", 0.5), (0.5, 0.9, 3.0), "transfer, guided", 48),
    ((0.9, 1.0, "isotropic", 0.0), (1.0, 0.5, 0.0), "transfer, guided", 48),
    ((0.9, 2.0, "rayleigh", 0.0), (0.8, 0.2, 0.3), "transfer, guided", 48),
    ((0.99, 10.0, "hg", 0.8), (0.05, 1.0, 0.0), "transfer, guided", 48),
    ((0.9, 1.0, "hg", 0.9), (1.0, 0.6, 0.0), "transfer, guided", 48),
]


def made(medium, directions, walk):
    if walk == "isotropic":
        return _core.isotropic_walk(medium, *directions[:2])
    return {"by terms": _core.slab_scattering_walk, "transfer, guided": _core.guided_transfer_walk}[walk](
        medium, *directions)


def estimate(medium, directions, walk, blocks, seed=11):
    total, squares, largest, count, events = _core.run_walk(made(medium, directions, walk), seed, 0, blocks, POOL)
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
    assert error < 0.02 * truth


HARD = [
    ((1.0, 50.0, "isotropic", 0.0), (0.5, 0.5, 1.0), "isotropic", 16),
    ((0.9, 1.0, "hg", 0.9), (1.0, 0.6, 0.0), "transfer, guided", 24),
    ((0.95, 1.0, "hg", 0.6), (0.05, 0.05, 0.5), "transfer, guided", 16),
]


@pytest.mark.parametrize("medium, directions, walk, blocks", HARD, ids=["thick", "peaked", "grazing"])
def test_unbiased_where_it_is_hard(medium, directions, walk, blocks):
    mean, error, _, _ = estimate(homogeneous(*medium), directions, walk, blocks, seed=3)
    truth = solved(medium, directions, 96)
    assert abs(mean - truth) < z_limit(len(HARD)) * math.hypot(error, 2e-5 * truth)
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
    mean, error, largest, _ = estimate(homogeneous(*medium), directions, "transfer, guided", 256, seed=21)
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


GRADED = {
    "albedo": [(0.0, 0.95, ("isotropic",)), (0.7, 0.3, ("isotropic",)), (2.0, 0.9, ("isotropic",))],
    "phase": [(0.0, 0.9, ("hg", 0.6)), (0.5, 0.5, ("hg", -0.2)), (1.5, 1.0, ("hg", 0.3))],
    "dark": [(0.0, 0.6, ("hg", 0.6)), (0.5, 0.3, ("hg", -0.2)), (1.0, 0.6, ("hg", 0.3))],
}


@pytest.mark.parametrize("knots, walk, blocks", [
    ("albedo", "isotropic", 8), ("albedo", "transfer, guided", 24), ("phase", "transfer, guided", 24),
    ("albedo", "by terms", 40), ("dark", "by terms", 40)])
@pytest.mark.parametrize("ground", [0.0, 0.6])
def test_media_that_vary_with_depth(knots, walk, blocks, ground):
    """Without tables, few large samples of bright media with a peak would dominate."""
    medium = _core.GradedMedium(GRADED[knots]).over(ground)
    mu_o, mu_i, dphi = 0.6, 0.35, 1.2
    mean, error, _, _ = estimate(medium, (mu_o, mu_i, dphi), walk, blocks)
    truth = _core.scattering_ode(medium, [mu_o, mu_i], [dphi], POOL)["brdf"][0, 1, 0]
    assert abs(mean - truth) < z_limit(10) * math.hypot(error, 2e-5 * truth)


@pytest.mark.parametrize("tau", [1e-9, 1e-4])
@pytest.mark.parametrize("kind, g, walk", [("isotropic", 0.0, "isotropic"), ("hg", 0.8, "by terms"),
                                           ("hg", 0.8, "transfer, guided")])
def test_thin_slabs(tau, kind, g, walk):
    """No digits are lost where exponentials differ by less than their rounding."""
    medium, directions = (0.9, tau, kind, g), (0.7, 0.4, 1.0)
    mean, error, _, _ = estimate(homogeneous(*medium), directions, walk, 2)
    truth = solved(medium, directions)
    assert abs(mean - truth) < z_limit(6) * math.hypot(error, 1e-6 * truth)


PIECES = [_core.Medium(0.9, 1.0, "hg", 0.7), _core.Medium(0.4, 0.7, "hg", 0.3)]


@pytest.mark.parametrize("layers, base, walk, gain", [
    ([_core.Medium(0.9, 2.0, "hg", 0.8)], _core.Base.none(), "transfer, guided", 100.0),
    ([_core.Medium(0.9, 2.0, "isotropic")], _core.Base.none(), "isotropic", 500.0),
    ([_core.Medium(0.9, 1.0, "hg", 0.7)], _core.Base.lambert(0.6), "transfer, guided", 10.0),
    (PIECES, _core.Base.none(), "transfer, guided", 40.0),
    (PIECES, _core.Base.lambert(0.6), "transfer, guided", 25.0),
])
def test_guided_walks_beat_the_plain_transfer_walk(layers, base, walk, gain):
    """By variance and events alone, with limits at a tenth of measured ratios or less: a broken guide would fail."""
    directions = (0.5, 0.5, math.pi / 2)
    whole = _core.Stack(layers, base)
    guided = estimate(_core.joined_media(whole), directions, walk, 4)
    plain = _core.transfer_walk(whole, _core.WalkTarget(*directions), next_event=_core.NextEvent.at_collision)
    total, squares, _, count, _ = _core.run_walk(plain, 11, 0, 20, POOL)
    variance = (squares / count - (total / count) ** 2) / (count - 1)
    assert variance / guided[1] ** 2 * 20.0 / 4.0 > gain


@pytest.mark.parametrize("medium, walk", [(("isotropic",), "isotropic"), (("hg", 0.8), "transfer, guided")])
def test_the_method_chooses_the_walk_for_the_medium(medium, walk):
    directions = (0.5, 0.4, 1.0)
    chosen = _core.scattering_walk(_core.Stack([_core.Medium(0.9, 2.0, *medium)], _core.Base.none()),
                                   _core.WalkTarget(*directions))
    named = made(_core.GradedMedium.homogeneous(0.9, 2.0, *medium), directions, walk)
    assert _core.run_walk(chosen, 5, 0, 1, POOL) == _core.run_walk(named, 5, 0, 1, POOL)


def test_grazing_views_of_media_that_vary_with_depth():
    """By reciprocity; towards the viewer, the standard error would be .7 %."""
    medium, (mu_o, mu_i, dphi) = _core.GradedMedium(GRADED["phase"]), (0.002, 0.7, 1.2)
    mean, error, _, _ = estimate(medium, (mu_o, mu_i, dphi), "transfer, guided", 8)
    truth = _core.scattering_ode(medium, [mu_o, mu_i], [dphi], POOL)["brdf"][0, 1, 0]
    assert abs(mean - truth) < z_limit(1) * math.hypot(error, 2e-5 * truth)
    assert error < 0.005 * truth


@pytest.mark.parametrize("ground", [0.0, 0.6])
def test_media_that_absorb_all_light(ground):
    medium, directions = homogeneous(0.0, 0.5, "hg", 0.5).over(ground), (0.5, 0.8, 1.0)
    mean, error, _, _ = estimate(medium, directions, "transfer, guided", 1)
    assert error <= 1e-9 * mean
    assert mean == pytest.approx(ground / math.pi * math.exp(-0.5 / 0.5 - 0.5 / 0.8), rel=1e-12)


def test_the_isotropic_walk_refuses_other_media():
    with pytest.raises(ValueError, match="phase: must be isotropic"):
        _core.isotropic_walk(homogeneous(0.9, 1.0, "hg", 0.1), 1.0, 1.0)


@pytest.mark.parametrize("walk", ["by terms", "transfer, guided"])
def test_blocks_and_threads(walk):
    walk = made(homogeneous(0.9, 2.0, "hg", 0.8), (0.5, 0.5, 1.0), walk)
    one = _core.run_walk(walk, 5, 0, 4, _core.ThreadPool(1))
    assert one == _core.run_walk(walk, 5, 0, 4, _core.ThreadPool(2))
    parts = [_core.run_walk(walk, 5, k, k + 1, POOL) for k in range(4)]
    assert one[0] == sum(part[0] for part in parts) and one[3] == 4 * BLOCK


@pytest.mark.parametrize("knots, words", [
    ([(0.0, 0.5, ("isotropic",))], "must be at least two"),
    ([(0.1, 0.5, ("isotropic",)), (1.0, 0.5, ("isotropic",))], "the first at tau = 0"),
    ([(0.0, 0.5, ("isotropic",)), (0.0, 0.5, ("isotropic",))], "must ascend"),
])
def test_knots_that_are_none(knots, words):
    with pytest.raises(ValueError, match=words):
        _core.GradedMedium(knots)
