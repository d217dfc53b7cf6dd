# SPDX-License-Identifier: GPL-3.0-or-later
"""Every closure of the dictionary, and some closures made for a stack, in Cycles against their closed forms."""
import math

import goniophotometer
import numpy as np
import pytest

from lamina import lobes
from lamina.closures import closure_table

# (mu_o, mu_i, dphi): normal and grazing, forward, backward and off the plane of incidence.
DIRECTIONS = [
    (0.97, 0.97, 1.3), (0.9, 0.5, 0.3), (0.8, 0.8, 0.0), (0.8, 0.3, math.pi), (0.6, 0.55, 0.02),
    (0.5, 0.9, 2.0), (0.5, 0.5, 3.1), (0.35, 0.06, 0.0), (0.3, 0.7, 1.57), (0.2, 0.3, 0.1),
    (0.2, 0.25, 2.5), (0.1, 0.7, 3.0), (0.05, 0.04, 0.4),
]
# Directions near the mirror direction and near straight through, where narrow lobes have all of their light.
DIRECTIONS += [
    (mu, mu * share, dphi) for mu in (0.95, 0.6, 0.25) for share, dphi in ((1.0, 0.01), (0.97, 0.02), (1.02, 0.1))
]
GRID = closure_table.light_grid(8, 8)
FURNACE_COSINES = (0.85, 0.25)

MADE_TO_MEASURE = [
    "ggx:0.03", "ggx:0.1", "ggx:0.4", "beckmann:0.1", "beckmann:0.3",
    "fresnel_ggx:1.5:0.03", "fresnel_ggx:1.5:0.1", "fresnel_ggx:1.1:0.27",
    "halo:0.05", "halo:0.14", "halo:0.55",
    "toon:0:0.07:0.4", "toon:0.1:0.017:0.04", "toon:0.35:0.017:0.1", "toon:0.6:0.1:0.4", "toon:1:0.03:0.13",
]
LOBES = [*lobes.DICTIONARY, *map(lobes.by_id, MADE_TO_MEASURE)]

SINGLE_PRECISION = 1.2e-7
# Largest error in radians of the polynomial by which Cycles' Hair BSDF takes arc cosines (fast_acosf).
FAST_ACOS = 4.6e-5
STEEPEST = 3.0  # tangent of the largest elevation among the directions


def tolerance(lobe):
    """Relative tolerance: 1e-4, plus the effect of single precision in Cycles' own formulas on narrow lobes.

    Facets: the distribution's denominator is sin^2 + alpha^2 cos^2 of the half vector, squared, and Cycles takes
    sin^2 as 1 - cos^2. Hair: two elevations, halved, and an azimuth, off by FAST_ACOS each; a Lorentzian of width w
    changes by at most FAST_ACOS / w, the cosine of an elevation by its tangent times that."""
    inputs = lobe.node.inputs
    if lobe.strays:
        return 1e-4 + FAST_ACOS * (1.0 / inputs["RoughnessU"] + 1.0 / inputs["RoughnessV"] + STEEPEST)
    if lobe.node.type in ("ShaderNodeBsdfAnisotropic", "ShaderNodeBsdfPrincipled"):
        if lobe.node.of_cosine:
            alpha = lobe.node.of_cosine["Roughness"][1] ** 2
        else:
            alpha = inputs["Roughness"] ** 2 * (1.0 - inputs.get("Anisotropy", 0.0))
        return 1e-4 + 2.0 * SINGLE_PRECISION / alpha**2
    return 1e-4


@pytest.fixture(scope="module")
def materials():
    return [goniophotometer.material_from_recipe(lobe) for lobe in LOBES]


def albedo(lobe, mu_o):
    """As the bake takes it, for one of its columns and between two."""
    columns = closure_table.view_cosines()
    at = np.arccos(mu_o) / (np.pi / 2) * (len(columns) - 1)
    return float(np.interp(at, np.arange(len(columns)), closure_table.only(GRID, False, (lobe.id,)).albedo[:, 0]))


def _of_side(side):
    return [k for k, lobe in enumerate(LOBES) if lobe.side == side]


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
        lobe = LOBES[k]
        expected = np.array([float(lobe.evaluate(*direction)) for direction in DIRECTIONS])
        scale = np.maximum(expected, 0.01 * expected.max())
        error = np.abs(measured[:, column] - expected[:, None]) / scale[:, None]
        worst = np.unravel_index(error.argmax(), error.shape)
        assert error.max() <= tolerance(lobe), f"{lobe.id} at {DIRECTIONS[worst[0]]}: {error.max():.1e}"


@pytest.mark.parametrize("mu_o", FURNACE_COSINES)
def test_sampling_in_cycles_agrees_with_the_value(materials, mu_o):
    """A closure whose sampling misses part of its value would lose energy under a sky. One that Cycles samples
    beyond the horizon too shows all of it."""
    furnace = goniophotometer.furnace_many(materials, mu_o, samples=2048)
    for lobe, reading in zip(LOBES, furnace, strict=True):
        expected = 1.0 if lobe.strays else albedo(lobe, mu_o)
        assert reading.mean() == pytest.approx(expected, rel=0.01, abs=2e-5), lobe.id


def test_weight_is_linear_and_has_no_upper_limit():
    lobe = lobes.by_id("p13")
    weight = (800.0, 1.0, 0.0)
    material = goniophotometer.material_from_recipe(lobe, weight)
    direction = (0.3, 0.2, 0.3)
    expected = np.array(weight) * float(lobe.evaluate(*direction))
    assert goniophotometer.measure(material, *direction, samples=1) == pytest.approx(expected, rel=1e-4)
