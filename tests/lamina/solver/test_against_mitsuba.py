# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole stacks against Mitsuba 3's volpath, which traces paths through the same surfaces and media: albedos and
some BRDFs, judged by their standard errors (.06 to .4 % of albedos, .2 to 1.8 % of BRDFs).

Boundaries here mask both directions independently and do not compensate lost energy, as in Mitsuba. BRDFs of bare
Beckmann facets are not compared: Mitsuba's masking is a rational fit with errors of up to .3 %."""

import functools
import json
import math
from pathlib import Path

import pytest
from mitsuba_scenes import estimate
from scipy.stats import chi2
from z_limit import z_limit

import lamina
from lamina import Stack

CASES = {case["id"]: case
         for case in json.loads((Path(__file__).parents[2] / "data/mitsuba_stacks.json").read_text(encoding="utf-8"))}
COUNT = sum(len(case["albedos"]) + len(case["brdf"]) for case in CASES.values())
# Half of the family's 1 % for the worst of all comparisons, half for their sum of squares.
LEVEL = 0.005


def stack_of(name: str) -> Stack:
    return Stack.from_json({key: CASES[name][key] for key in ("schema", "layers", "base")})


@functools.cache
def scores(name: str) -> tuple[tuple[str, float], ...]:
    """(quantity, Z) of every comparison of a stack."""
    case, stack = CASES[name], stack_of(name)
    solved = lamina.solve(stack)
    found = []
    for number, ask in enumerate(case["albedos"]):
        mean, error = estimate(stack, ask["mu"], ask["quantity"], case["samples"], number + 1)
        exact = float(getattr(solved, ask["quantity"])(ask["mu"])[0])
        found.append((f"{ask}: {mean:.5f} +- {error:.5f}, solved {exact:.5f}", (exact - mean) / error))
    for number, ask in enumerate(case["brdf"]):
        mean, error = estimate(stack, ask["mu_o"], "brdf", case["samples"], number + 101, ask["mu_i"], ask["dphi"])
        exact = float(solved.brdf(**ask)[0])
        found.append((f"{ask}: {mean:.5f} +- {error:.5f}, solved {exact:.5f}", (exact - mean) / error))
    return tuple(found)


@pytest.mark.parametrize("name", CASES)
def test_stack(name):
    limit = z_limit(COUNT, LEVEL)
    bad = [f"{what}, Z = {z:.2f}" for what, z in scores(name) if not abs(z) < limit]
    assert not bad, "; ".join(bad)


def test_all_together():
    """Small errors of many values add up where each hides in its noise."""
    total = sum(z * z for name in CASES for _, z in scores(name))
    assert total < chi2.ppf(1.0 - LEVEL, COUNT), f"{total:.1f} for {COUNT} values"


def test_way_of_sampling_facets_does_not_matter():
    """The oracle itself: facets sampled by visible normals, and by all normals."""
    stack = stack_of("rough coat on lambert")
    (one, error), (other, its_error) = (estimate(stack, 0.9, "reflectance", 100_000, 5, visible=visible)
                                        for visible in (True, False))
    assert abs(one - other) < z_limit(1) * math.hypot(error, its_error)
