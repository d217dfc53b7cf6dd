# SPDX-License-Identifier: GPL-3.0-or-later
"""Every closure of the dictionary, measured in Cycles against its closed form."""
import math

import goniophotometer
import numpy as np
import pytest

from lamina import lobes

# (mu_o, mu_i, dphi): normal and grazing, forward, backward and off the plane of incidence.
DIRECTIONS = [
    (0.97, 0.97, 1.3), (0.9, 0.5, 0.3), (0.8, 0.8, 0.0), (0.8, 0.3, math.pi), (0.6, 0.55, 0.02),
    (0.5, 0.9, 2.0), (0.5, 0.5, 3.1), (0.35, 0.06, 0.0), (0.3, 0.7, 1.57), (0.2, 0.3, 0.1),
    (0.2, 0.25, 2.5), (0.1, 0.7, 3.0), (0.05, 0.04, 0.4),
]
TOLERANCE = 1e-4
FURNACE_COSINES = (0.85, 0.25)


@pytest.fixture(scope="module")
def materials():
    return [goniophotometer.material_from_recipe(lobe) for lobe in lobes.DICTIONARY]


def _of_side(side):
    return [k for k, lobe in enumerate(lobes.DICTIONARY) if lobe.side == side]


@pytest.mark.parametrize("side", ["reflection", "transmission"])
@pytest.mark.parametrize("backface", [False, True], ids=["front", "back"])
def test_value_in_cycles_is_the_closed_form(materials, side, backface):
    chosen = _of_side(side)
    measured = np.array([
        goniophotometer.measure_many(
            [materials[k] for k in chosen], *direction, samples=1,
            below=side == "transmission", backface=backface,
        )
        for direction in DIRECTIONS
    ])
    for column, k in enumerate(chosen):
        lobe = lobes.DICTIONARY[k]
        expected = np.array([float(lobe.evaluate(*direction)) for direction in DIRECTIONS])
        scale = np.maximum(expected, 0.01 * expected.max())
        error = np.abs(measured[:, column] - expected[:, None]) / scale[:, None]
        worst = np.unravel_index(error.argmax(), error.shape)
        assert error.max() <= TOLERANCE, f"{lobe.id} at {DIRECTIONS[worst[0]]}: {error.max():.1e}"


@pytest.mark.parametrize("mu_o", FURNACE_COSINES)
def test_sampling_in_cycles_agrees_with_the_value(materials, mu_o):
    """A closure whose sampling misses part of its value would lose energy under a sky."""
    furnace = goniophotometer.furnace_many(materials, mu_o, samples=2048)
    for lobe, reading in zip(lobes.DICTIONARY, furnace, strict=True):
        expected = float(lobes.directional_albedo(lobe, mu_o))
        assert reading.mean() == pytest.approx(expected, rel=0.01, abs=2e-5), lobe.id


def test_weight_is_linear_and_has_no_upper_limit():
    lobe = lobes.by_id("p13")
    weight = (800.0, 1.0, 0.0)
    material = goniophotometer.material_from_recipe(lobe, weight)
    direction = (0.3, 0.2, 0.3)
    expected = np.array(weight) * float(lobe.evaluate(*direction))
    assert goniophotometer.measure(material, *direction, samples=1) == pytest.approx(expected, rel=1e-4)
