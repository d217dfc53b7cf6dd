# SPDX-License-Identifier: GPL-3.0-or-later
"""Windows around the points of a map, against NumPy."""

import numpy as np
import pytest

from lamina import _core

POINTS, NEIGHBOURS, RIDGE = 1300, 30, 1e-3


def arrays(uniform):
    """(numbers, weights, places) of random neighbours, of which some are missing."""
    rng = np.random.default_rng(4)
    numbers = rng.integers(-100, POINTS, size=(NEIGHBOURS, POINTS)).astype(np.int32)
    numbers[0] = np.arange(POINTS)
    shape = (NEIGHBOURS,) if uniform else numbers.shape
    weights = rng.uniform(0.1, 1.0, shape).astype(np.float32)
    places = rng.uniform(-1.0, 1.0, (*shape, 2)).astype(np.float32)
    places[0] = 0.0
    if not uniform:
        weights[5:9, ::3] = 0.0
    return numbers, weights, places


@pytest.mark.parametrize("uniform", [False, True])
def test_means_and_regressions(uniform):
    """The regression against least squares of numpy with the ridge as further equations."""
    numbers, weights, places = given = arrays(uniform)
    rng = np.random.default_rng(5)
    values, guides = rng.normal(size=(POINTS, 4)), rng.normal(size=(POINTS, 3))
    window = _core.Window(*given)
    pool = _core.ThreadPool(2)
    mean, (fit, leverage) = window.mean(values, pool), window.regression(guides, values, RIDGE, pool)
    for point in (0, 3, 511, 512, POINTS - 1):
        there = numbers[:, point] >= 0
        chosen = numbers[there, point]
        weight = (weights if uniform else weights[:, point])[there].astype(float)
        place = (places if uniform else places[:, point])[there]
        assert mean[point] == pytest.approx(np.average(values[chosen], axis=0, weights=weight), rel=1e-12)
        rows = np.column_stack([np.ones(len(chosen)), place, guides[chosen] - guides[point]])
        ridge = np.sqrt(RIDGE * weight.sum()) * np.eye(6)[1:]
        root = np.sqrt(weight)[:, None]
        wanted = np.linalg.lstsq(np.vstack([root * rows, ridge]),
                                 np.vstack([root * values[chosen], np.zeros((5, 4))]), rcond=None)[0][0]
        assert fit[point] == pytest.approx(wanted, rel=1e-9, abs=1e-12)
        matrix = (root * rows).T @ (root * rows) + ridge.T @ ridge
        assert leverage[point] == pytest.approx(np.linalg.inv(matrix)[0, 0], rel=1e-9)


def test_threads_change_nothing():
    window, values = _core.Window(*arrays(False)), np.random.default_rng(6).normal(size=(POINTS, 5))
    one, three = (window.regression(values[:, :2], values, RIDGE, _core.ThreadPool(count)) for count in (1, 3))
    assert all(np.array_equal(a, b) for a, b in zip(one, three, strict=True))


def test_nearest_vertices():
    """Of neighbours and their neighbours, against distances to all of them."""
    rng = np.random.default_rng(7)
    positions = rng.uniform(size=(900, 3))
    along = rng.integers(900, size=(900, 4)).astype(np.int32)
    along[::7, 2:] = np.arange(900)[::7, None]  # missing neighbours
    found = _core.nearest_vertices(positions, along, 12, _core.ThreadPool(2))
    for vertex in range(0, 900, 13):
        reached = set(along[vertex]) | set(along[along[vertex]].ravel())
        nearest = sorted(reached - {vertex}, key=lambda other: np.sum((positions[other] - positions[vertex]) ** 2))
        wanted = [vertex, *nearest[:11]]
        assert list(found[vertex]) == wanted + [vertex] * (12 - len(wanted))


def test_wrong_shapes_are_refused():
    numbers, weights, places = arrays(False)
    with pytest.raises(ValueError, match="weights and places must have"):
        _core.Window(numbers, weights[:5], places)
    with pytest.raises(ValueError, match="numbers must be below the number of points"):
        _core.Window(np.where(numbers == 7, POINTS, numbers).astype(np.int32), weights, places)
    window, pool = _core.Window(numbers, weights, places), _core.ThreadPool(1)
    with pytest.raises(ValueError, match="values must have the shape"):
        window.mean(np.ones((POINTS - 1, 2)), pool)
    with pytest.raises(ValueError, match="guides must have at most five columns"):
        window.regression(np.ones((POINTS, 6)), np.ones((POINTS, 2)), RIDGE, pool)
