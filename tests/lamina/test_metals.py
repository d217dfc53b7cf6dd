# SPDX-License-Identifier: GPL-3.0-or-later
"""Metals by name and by two colours."""

import math

import numpy as np
import pytest

import lamina
from lamina import Conductor, Stack, StackError, metals

COSINES = (1.0, math.cos(math.radians(82.0)))


def mirrored(stack):
    """Reflectances of a smooth metal at 0 and 82 degrees, by the solver."""
    return lamina.solve(stack, threads=1).reflectance(np.array(COSINES))


@pytest.mark.parametrize("name", metals.names())
def test_the_table(name):
    metal = metals.conductor(name, alpha=0.3, distribution="beckmann")
    assert len(metal.eta) == len(metal.k) == 3 and metal.alpha == 0.3 and metal.distribution == "beckmann"
    assert any(year in metals.source(name) for year in ("1972", "1974", "1982", "1985", "1995", "1998", "2009"))
    assert "615, 545 and 465 nm" in metals.source(name)
    facing, grazing = metals.colours_of(metal)
    assert all(0.3 < f < 1.0 and f < 1.0 and g > 0.5 for f, g in zip(facing, grazing, strict=True))


def test_the_metals_have_the_colours_that_they_are_known_for():
    assert {"gold", "silver", "copper", "aluminium", "iron", "brass", "chromium", "nickel", "titanium", "platinum",
            "zinc"} <= set(metals.names())
    for warm in ("gold", "copper", "brass", "commercial-bronze"):
        red, green, blue = metals.colours_of(metals.conductor(warm))[0]
        assert red > green > blue and red > 0.85
    for light in ("silver", "aluminium"):
        assert min(metals.colours_of(metals.conductor(light))[0]) > 0.88


def test_colours_of_either_form():
    facing, grazing = metals.colours_of(Conductor([0.2, 1.0], 3.0))
    assert facing == pytest.approx([(0.8**2 + 9) / (1.2**2 + 9), 9 / 13], rel=1e-12)
    assert metals.colours_of(Conductor(facing=0.8, grazing=0.85)) == (pytest.approx([0.8]), pytest.approx([0.85]))
    with pytest.raises(StackError, match=r"^conductor.eta = 0: must lie in \[0.001, 100\]$"):
        metals.colours_of(Conductor(0, 3.0))
    assert len(grazing) == 2


def test_measured_points():
    """Johnson and Christy (1972): gold at 616.8 nm and 582.1 nm is .21 + 3.272 i and .29 + 2.863 i."""
    red = metals.conductor("gold")
    share = (615.0 - 582.1) / (616.8 - 582.1)
    assert red.eta[0] == pytest.approx(0.29 + share * (0.21 - 0.29), abs=1e-4)
    assert red.k[0] == pytest.approx(2.863 + share * (3.272 - 2.863), abs=1e-3)


def test_an_unknown_metal():
    for call in (metals.conductor, metals.source):
        with pytest.raises(KeyError) as caught:
            call("goldd")
        assert str(caught.value).startswith("metal = 'goldd': unknown; the nearest of 15 are gold, ")


@pytest.mark.parametrize("name", metals.names())
def test_two_colours_give_the_indices_back(name):
    metal = metals.conductor(name)
    facing, grazing = metals.colours_of(metal)
    stack = Stack([], Conductor(facing=facing, grazing=grazing))
    for c in range(3):
        assert stack.indices(c) == pytest.approx((metal.eta[c], metal.k[c]), rel=1e-7)


@pytest.mark.parametrize("facing, grazing", [(0.04, 0.5), (0.3, 0.8), (0.5, 0.46), (0.95, 0.9), (0.99, 0.995),
                                             (0.5, 1.0), (1.0, 1.0), (0.0, 0.0), (0.9999, 0.99975)])
def test_the_solver_shows_both_colours(facing, grazing):
    stack = Stack([], Conductor(facing=facing, grazing=grazing))
    np.testing.assert_allclose(mirrored(stack)[:, 0], [facing, grazing], atol=1e-5)


def test_grazing_falls_with_eta():
    etas = [Stack([], Conductor(facing=0.7, grazing=g)).indices(0)[0] for g in np.linspace(0.51, 1.0, 40)]
    assert all(a > b for a, b in zip(etas, etas[1:], strict=False))


def test_json_keeps_the_colours_and_the_hash_means_the_indices():
    stack = Stack([], Conductor(facing=[0.9, 0.7, 0.4], grazing=0.95, alpha=0.2))
    data = stack.to_json()
    assert data["base"] == {"kind": "conductor", "facing": [0.9, 0.7, 0.4], "grazing": 0.95, "alpha": 0.2}
    assert Stack.from_json(data) == stack and "facing" not in stack.canonical()
    eta, k = zip(*(stack.indices(c) for c in range(3)), strict=True)
    assert Stack([], Conductor(eta, k, 0.2)).hash == stack.hash


@pytest.mark.parametrize("base, sentence", [
    ({}, "base has no coefficients: must have either eta, k or facing, grazing"),
    ({"eta": 0.2}, "base.k is missing: must have either eta, k or facing, grazing"),
    ({"facing": 0.2}, "base.grazing is missing: must have either eta, k or facing, grazing"),
    ({"eta": 0.2, "k": 3.0, "facing": 0.2}, "base has two forms: must have either eta, k or facing, grazing"),
    ({"facing": 1.5, "grazing": 0.9}, "base.facing = 1.5: must lie in [0, 1]"),
    ({"facing": [0.9, 0.5], "grazing": [0.9, 0.9, 0.9]},
     "base.grazing has 3 channels: must have 2 like base.facing"),
    ({"facing": 0.0, "grazing": 0.9}, "base.grazing = 0.9: a metal of facing colour 0 shows 0 at 82 degrees"),
    ({"facing": [0.5, 0.9], "grazing": [0.9, 0.5]},
     "base.grazing[1] = 0.5: a metal of facing colour 0.9 shows between 0.7252 and 0.9999 at 82 degrees"),
])
def test_bad_conductors(base, sentence):
    for make in (lambda: Stack([], Conductor(**base)),
                 lambda: Stack.from_json({"schema": 1, "layers": [], "base": {"kind": "conductor", **base}})):
        with pytest.raises(StackError) as caught:
            make()
        assert str(caught.value) == sentence
