# SPDX-License-Identifier: GPL-3.0-or-later
"""The closure fit on random problems, against SciPy's non-negative least squares."""

import numpy as np
import pytest
from scipy.optimize import nnls

from lamina import _core

POOL = _core.ThreadPool(2)
COLUMNS, LIGHTS = 3, 40
ALBEDO_WEIGHT = 1e3  # the core's default


def problem(seed, closures, slices=6):
    random = np.random.default_rng(seed)
    values = random.random((COLUMNS, closures, LIGHTS)) ** 3
    solid_angle = random.random(LIGHTS) + 0.1
    targets = random.random((slices, COLUMNS, LIGHTS)) ** 2
    albedo = np.einsum("scl,l->sc", targets, solid_angle)
    return values, solid_angle, targets, albedo


def reference(values, solid_angle, target, albedo):
    """The same objective as rows for SciPy: slice, then albedo with its weight; then scaled to the albedo."""
    root = np.sqrt(solid_angle)
    norm = np.linalg.norm(target * root)
    own = values @ solid_angle
    weight = np.sqrt(ALBEDO_WEIGHT) * norm / albedo
    x, _ = nnls(np.vstack([(values * root).T, weight * own]), np.append(target * root, weight * albedo))
    x *= albedo / (own @ x)
    return x, np.linalg.norm((x @ values - target) * root) / norm


@pytest.mark.parametrize("closures", [1, 2, 5, 12, 24])
@pytest.mark.parametrize("seed", range(5))
def test_against_scipy(closures, seed):
    values, solid_angle, targets, albedo = problem(seed, closures)
    table = _core.ClosureTable(values, solid_angle, values @ solid_angle)
    weights, errors = table.fit(table.targets(targets, albedo, POOL), list(range(closures)), POOL)
    assert weights.shape == (6, COLUMNS, closures) and errors.shape == (6, COLUMNS)
    for s in range(6):
        for c in range(COLUMNS):
            x, error = reference(values[c], solid_angle, targets[s, c], albedo[s, c])
            assert weights[s, c] == pytest.approx(x, abs=1e-7)
            assert errors[s, c] == pytest.approx(error, rel=1e-7)
            assert weights[s, c] @ (values[c] @ solid_angle) == pytest.approx(albedo[s, c], rel=1e-12)


def test_a_mixture_is_found_again():
    values, solid_angle, *_ = problem(7, 8)
    true = np.array([0.0, 1.0, 0.0, 0.2, 3.0, 0.0, 0.0, 0.5])
    targets = np.einsum("k,ckl->cl", true, values)[None]
    table = _core.ClosureTable(values, solid_angle, values @ solid_angle)
    prepared = table.targets(targets, targets @ solid_angle, POOL)
    weights, errors = table.fit(prepared, list(range(8)), POOL)
    assert weights[0] == pytest.approx(np.broadcast_to(true, (COLUMNS, 8)), abs=1e-7)
    assert errors.max() < 1e-6
    options = _core.SelectionOptions()
    options.closures = 4
    assert list(table.select(prepared, options, [], [], POOL).closures) == [1, 3, 4, 7]


@pytest.mark.parametrize("weights, expected", [((1.0, 1e-4), 2), ((1e-4, 1.0), 5)])
def test_a_choice_follows_the_weights_of_the_slices(weights, expected):
    values, solid_angle, *_ = problem(7, 8)
    targets = np.stack([values[:, 2], values[:, 5]])
    table = _core.ClosureTable(values, solid_angle, values @ solid_angle)
    prepared = table.targets(targets, targets @ solid_angle, POOL)
    for target, weight in zip(prepared, np.repeat(weights, COLUMNS), strict=True):
        target.weight = weight
    options = _core.SelectionOptions()
    options.closures = 1
    found = table.select(prepared, options, [], [], POOL)
    assert list(found.closures) == [expected]
    # Errors are those of the slices, each times the root of its weight
    _, errors = table.fit(prepared, [expected], POOL)
    weighted = errors * np.sqrt(weights)[:, None]
    assert found.mean_error == pytest.approx(weighted.mean(), rel=1e-6)
    assert found.worst_error == pytest.approx(weighted.max(), rel=1e-6)


def test_nearly_equal_closures_do_not_cancel():
    values, solid_angle, targets, albedo = problem(3, 6)
    values[:, 3] = values[:, 2] * (1.0 + 1e-9)
    table = _core.ClosureTable(values, solid_angle, values @ solid_angle)
    weights, errors = table.fit(table.targets(targets, albedo, POOL), list(range(6)), POOL)
    assert np.all(np.isfinite(weights)) and weights.min() >= 0.0
    for s in range(6):
        for c in range(COLUMNS):
            _, error = reference(values[c], solid_angle, targets[s, c], albedo[s, c])
            assert errors[s, c] == pytest.approx(error, rel=1e-6)


def test_a_black_slice_gets_no_weight():
    values, solid_angle, targets, _ = problem(1, 5)
    table = _core.ClosureTable(values, solid_angle, values @ solid_angle)
    weights, errors = table.fit(table.targets(0.0 * targets, np.zeros((6, COLUMNS)), POOL), [0, 1, 2], POOL)
    assert np.all(weights == 0.0) and np.all(errors == 0.0)


def test_bad_shapes_and_counts_are_refused():
    values, solid_angle, targets, albedo = problem(1, 30)
    table = _core.ClosureTable(values, solid_angle, values @ solid_angle)
    prepared = table.targets(targets, albedo, POOL)
    with pytest.raises(ValueError, match="axes"):
        _core.ClosureTable(values[0], solid_angle, values @ solid_angle)
    with pytest.raises(ValueError, match="light grid"):
        _core.ClosureTable(values, solid_angle[:-1], values @ solid_angle)
    with pytest.raises(ValueError, match="light grid"):
        table.targets(targets[:, :, :-1], albedo, POOL)
    with pytest.raises(ValueError, match="kMaxClosures"):
        table.fit(prepared, list(range(_core.MAX_CLOSURES + 1)), POOL)
    options = _core.SelectionOptions()
    options.closures = 0
    with pytest.raises(ValueError, match="number of closures"):
        table.select(prepared, options, [], [], POOL)
