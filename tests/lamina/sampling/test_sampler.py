# SPDX-License-Identifier: GPL-3.0-or-later
"""Directions drawn for a view: their mean weight is the albedo, and their density is the one that is stated."""

import numpy as np
import pytest
from z_limit import z_limit

import lamina
from lamina import (
    ArgumentError,
    Conductor,
    HenyeyGreenstein,
    Interface,
    Lambert,
    Medium,
    Sampler,
    Stack,
    StackError,
)

GOLD = Conductor(facing=(1.0, 0.7837, 0.3427), grazing=(1.0, 0.8899, 0.6307), alpha=0.2)
STACKS = {
    "varnish": Stack([Interface(1.5, 0.1), Medium(0.8, 0.5, HenyeyGreenstein(0.6))], Lambert(0.3)),
    "lacquered gold": Stack([Interface(1.5)], GOLD),
    "smooth paint": Stack([Interface(1.5), Medium((0.9, 0.5, 0.2), 3.0)], Lambert(0.1)),
    "road sign": Stack([Interface(1.5), Medium((0.9, 0.5, 0.2), 0.7)], lamina.Retroreflector(0.7, 0.1)),
    "sheet": Stack([Medium((0.9, 0.6, 0.3), 0.7, HenyeyGreenstein(0.8))], None),
}
VIEWS = [np.array([0.6 * (1.0 - mu**2) ** 0.5, -0.8 * (1.0 - mu**2) ** 0.5, mu]) for mu in (0.95, 0.5, 0.2)]
COUNT = 10000


@pytest.fixture(scope="module", params=STACKS)
def function(request):
    return lamina.solve(STACKS[request.param], "preview")


@pytest.fixture(scope="module")
def sampler(function):
    return Sampler(function)


def albedo(function, mu, side="top"):
    found = function.reflectance(mu, side)
    return found + function.transmittance(mu, side) if function.stack.base is None else found


def numbers(seed, count=COUNT):
    return np.random.default_rng(seed).random((count, 4))


@pytest.mark.parametrize("view", VIEWS)
def test_the_mean_weight_is_the_albedo(function, sampler, view):
    drawn = sampler.sample(view, numbers(1))
    error = drawn.weight.std(axis=0) / COUNT**0.5
    z = (drawn.weight.mean(axis=0) - albedo(function, view[2])) / error
    assert np.abs(z).max() < z_limit(36)
    grey = drawn.weight.mean(axis=1)
    assert grey.std() < 0.8 * grey.mean(), "few directions have large weights"


@pytest.mark.parametrize("view", VIEWS)
def test_weights_are_values_over_densities(sampler, view):
    drawn = sampler.sample(view, numbers(2, 300))
    own = ~drawn.is_delta
    np.testing.assert_allclose(np.linalg.norm(drawn.light, axis=1), 1.0, rtol=1e-12)
    np.testing.assert_allclose(sampler.pdf(view, drawn.light[own]), drawn.pdf[own], rtol=1e-9)
    np.testing.assert_allclose(sampler.evaluate(view, drawn.light[own]) / drawn.pdf[own, None], drawn.weight[own],
                               rtol=1e-4)  # the solver's values depend on their neighbours by some 1e-5


def test_directions_have_the_stated_density(sampler):
    """Chi-squared over cells of the sphere. The density integrates to the share of directions that are no deltas."""
    view, fine, count = VIEWS[1], 24, 10000
    drawn = sampler.sample(view, numbers(3, count))
    light = drawn.light[~drawn.is_delta]
    z_edges, turns = np.linspace(-1.0, 1.0, 9), np.linspace(-np.pi, np.pi, 9)
    counts = np.histogram2d(light[:, 2], np.arctan2(light[:, 1], light[:, 0]), [z_edges, turns])[0]
    z = (np.arange(8 * fine) + 0.5) / (4 * fine) - 1.0
    turn = ((np.arange(8 * fine) + 0.5) / (4 * fine) - 1.0) * np.pi
    # Points are jittered: the density has steps, and edges of its cells are parallel to those of the rule.
    random, widths = np.random.default_rng(6), (0.25 / fine, 0.25 * np.pi / fine)
    grid = [part + random.uniform(-0.5, 0.5, part.shape) * width
            for part, width in zip(np.meshgrid(z, turn, indexing="ij"), widths, strict=True)]
    side = np.sqrt(1.0 - grid[0] ** 2)
    points = np.stack([side * np.cos(grid[1]), side * np.sin(grid[1]), grid[0]], axis=-1)
    density = sampler.pdf(view, points.reshape(-1, 3)) * 4.0 * np.pi / grid[0].size
    expected = count * density.reshape(8, fine, 8, fine).sum(axis=(1, 3))
    big = expected > 10.0
    squares = ((counts - expected)[big] ** 2 / expected[big]).sum()
    assert abs(squares - big.sum()) < z_limit(8) * np.sqrt(2.0 * big.sum()), (squares, big.sum())
    assert abs(expected.sum() - len(light)) < z_limit(8) * 0.5 * np.sqrt(count)


def test_mirror_images_and_unscattered_light():
    drawn = Sampler(lamina.solve(Stack([Interface(1.5)], Lambert(0.5)), "preview")).sample(VIEWS[1], numbers(4))
    assert 0.02 < drawn.is_delta.mean() < 0.3
    np.testing.assert_allclose(drawn.light[drawn.is_delta], np.broadcast_to(VIEWS[1] * [-1, -1, 1], (
        drawn.is_delta.sum(), 3)))
    sheet = Sampler(lamina.solve(STACKS["sheet"], "preview")).sample(VIEWS[0], numbers(5))
    np.testing.assert_allclose(sheet.light[sheet.is_delta], np.broadcast_to(-VIEWS[0], (sheet.is_delta.sum(), 3)))


def test_reciprocity_of_the_values(sampler):
    light = np.array([0.3, 0.5, np.sqrt(1.0 - 0.34)])
    there = sampler.evaluate(VIEWS[1], light) / light[2]
    back = sampler.evaluate(light, VIEWS[1]) / VIEWS[1][2]
    np.testing.assert_allclose(there, back, rtol=2e-3)


def test_a_table_has_the_values_that_cycles_renders():
    stack = Stack([Medium((0.9, 0.5, 0.2), 2.0, varying=True)], Lambert(0.3))
    lut = lamina.bake(stack, "preview")
    for tau in (0.2, 2.0):
        sampler = Sampler(lut, tau=tau)
        drawn = sampler.sample(VIEWS[0], numbers(6))
        error = drawn.weight.std(axis=0) / COUNT**0.5
        assert np.abs((drawn.weight.mean(axis=0) - lut.reflectance(VIEWS[0][2], tau=tau)) / error).max() < z_limit(6)
        value = sampler.evaluate(VIEWS[0], VIEWS[1] * [-1, 1, 1])
        assert value.shape == (1, 3) and np.all(value > 0.0)


def test_the_bottom_of_a_sheet():
    function = lamina.solve(Stack([Medium(0.9, 0.5), Medium(0.3, 0.5)], None), "preview")
    drawn = Sampler(function, "bottom").sample(VIEWS[1], numbers(7))
    z = (drawn.weight.mean(axis=0) - albedo(function, 0.5, "bottom")) / (drawn.weight.std(axis=0) / COUNT**0.5)
    assert np.abs(z).max() < z_limit(1)


@pytest.mark.parametrize(("call", "words"), [
    (lambda s: s.sample([0.0, 0.0, 1.0], [[0.5, 0.5, 0.5]]), r"must be \(n, 4\)"),
    (lambda s: s.sample([0.0, 0.0, 1.0], [[1.0, 0.5, 0.5, 0.5]]), r"\[0, 1\)"),
    (lambda s: s.sample([0.0, 0.0, -1.0], numbers(1, 2)), "another sampler"),
    (lambda s: s.evaluate([0.0, 0.0, 1.0], [0.0, 0.0, 2.0]), "unit vectors"),
    (lambda s: s.pdf([0.0, 0.0, 1.0], [[0.0, 1.0]]), "must be .n, 3."),
    (lambda s: s.pdf(np.tile([0.0, 0.0, 1.0], (2, 1)), np.tile([0.0, 0.0, 1.0], (3, 1))), "do not fit")])
def test_bad_directions(call, words):
    sampler = Sampler(lamina.solve(Stack([Medium(0.9, 0.5)], Lambert(0.3)), "preview"))
    with pytest.raises(ArgumentError, match=words):
        call(sampler)


def test_bad_functions():
    function = lamina.solve(Stack([Medium(0.9, 0.5)], Lambert(0.3)), "preview")
    with pytest.raises(ArgumentError, match=r"must be a lamina\.ScatteringFunction or"):
        Sampler(function.stack)
    with pytest.raises(ArgumentError, match="side"):
        Sampler(function, "left")
    with pytest.raises(ArgumentError, match="tau"):
        Sampler(function, tau=0.5)
    with pytest.raises(StackError, match="needs a sheet"):
        Sampler(function, "bottom")
    with pytest.raises(StackError, match="sampler"):
        Sampler(lamina.solve(Stack([Interface(1.5, 0.2, alpha_v=0.4)], Lambert(0.3)), "preview"))
