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
    assert len(metal.facing) == len(metal.grazing) == 3 and metal.alpha == 0.3 and metal.distribution == "beckmann"
    assert any(year in metals.source(name) for year in ("1972", "1974", "1975", "1982", "1985", "1995", "1998", "2009",
                                                        "2015"))
    assert metals.source(name).endswith("; spectrum integrated with the CIE 1931 observer under D65")
    assert metals.colours_of(metal) == (pytest.approx(metal.facing, abs=1e-5), pytest.approx(metal.grazing, abs=1e-5))


def test_the_usual_metals_are_there():
    assert {"gold", "silver", "copper", "aluminium", "iron", "brass", "chromium", "nickel", "titanium", "platinum",
            "zinc"} <= set(metals.names())


def test_colours_of_either_form():
    facing, grazing = metals.colours_of(Conductor([0.2, 1.0], 3.0))
    assert facing == pytest.approx([(0.8**2 + 9) / (1.2**2 + 9), 9 / 13], rel=1e-12)
    assert metals.colours_of(Conductor(facing=0.8, grazing=0.85)) == (pytest.approx([0.8]), pytest.approx([0.85]))
    with pytest.raises(StackError, match=r"^conductor.eta = 0: must lie in \[0.001, 100\]$"):
        metals.colours_of(Conductor(0, 3.0))
    assert len(grazing) == 2


def test_an_unknown_metal():
    for call in (metals.conductor, metals.source):
        with pytest.raises(KeyError) as caught:
            call("goldd")
        assert str(caught.value).startswith("metal = 'goldd': unknown; the nearest of 15 are gold, ")


@pytest.mark.parametrize("eta, k", [(0.2141, 3.251), (1.332, 1.869), (0.05948, 4.137), (3.173, 3.3), (1.34, 7.351)])
def test_two_colours_give_the_indices_back(eta, k):
    facing, grazing = metals.colours_of(Conductor(eta, k))
    stack = Stack([], Conductor(facing=facing, grazing=grazing))
    assert stack.indices(0) == pytest.approx((eta, k), rel=1e-7)


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
    ({}, "base has no coefficients: must have either eta, k or facing, grazing or metal"),
    ({"eta": 0.2}, "base.k is missing: must have either eta, k or facing, grazing or metal"),
    ({"facing": 0.2}, "base.grazing is missing: must have either eta, k or facing, grazing or metal"),
    ({"eta": 0.2, "k": 3.0, "facing": 0.2}, "base has two forms: must have either eta, k or facing, grazing or metal"),
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
