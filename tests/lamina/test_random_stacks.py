# SPDX-License-Identifier: GPL-3.0-or-later
"""A part of `make fuzz`: the first random stacks, solved; a refusal must be one short sentence."""

import random
import sys
from pathlib import Path

import pytest

import lamina
from lamina.kinds import bases, phases

sys.path.insert(0, str(Path(__file__).parents[1] / "fuzz"))
import invariants
from random_stacks import random_stack

SEED = 1
COUNT = 24


@pytest.mark.parametrize("number", range(COUNT))
def test_what_holds_for_every_stack(number):
    stack = random_stack(SEED, number)
    try:
        solved = lamina.solve(stack, invariants.QUALITY)
    except lamina.SolveError as refusal:
        assert str(refusal).startswith("the stack cannot be resolved") and len(str(refusal)) < 500
        return
    found = invariants.grids(solved)
    assert invariants.of_values(stack, found) + invariants.of_energy(solved) == []
    if number % 4 == 1:
        assert invariants.of_splitting(stack, found, random.Random(number)) == []


def test_added_kinds_take_part(monkeypatch):
    class AddedPhase(lamina.HenyeyGreenstein):
        pass

    class AddedBase(lamina.Lambert):
        pass

    monkeypatch.setattr(phases, "KINDS", (*phases.KINDS, AddedPhase))
    monkeypatch.setattr(bases, "KINDS", (*bases.KINDS, AddedBase))
    stacks = [random_stack(SEED, number) for number in range(300)]
    assert {type(stack.base) for stack in stacks} == set(bases.KINDS) | {type(None)}
    found = {type(layer.phase) for stack in stacks for layer in stack.layers
             if isinstance(layer, lamina.Medium) and layer.profile is None}
    assert found == set(phases.KINDS) | {lamina.Tabulated, lamina.Mixture}


def test_the_invariants_notice_what_is_wrong():
    """Each verdict fails on values that break it."""
    stack = lamina.Stack([lamina.Medium(albedo=1.0, tau=1.0, phase=lamina.HenyeyGreenstein(0.5))])
    solved = lamina.solve(stack, invariants.QUALITY)
    good = invariants.grids(solved)
    assert invariants.of_values(stack, good) + invariants.of_energy(solved) == []
    for change, word in ((lambda f: f * float("nan"), "finite"), (lambda f: f - 0.5 * f.max(), "negative")):
        assert any(word in text for text in invariants.of_values(stack, {k: change(f) for k, f in good.items()}))
    turned = {k: f * (1.0 + 1e-4 * invariants.MU[:, None, None, None]) for k, f in good.items()}
    assert any("reciprocity" in text for text in invariants.of_values(stack, turned))
    off = {k: 1.1 * f for k, f in good.items()}
    assert invariants.of_splitting(stack, off, random.Random(1))
    assert invariants.of_splitting(stack, good, random.Random(1)) == []
    assert any("walk" in text for text in invariants.of_walks(solved, off, random.Random(1), 9))
    assert invariants.of_walks(solved, good, random.Random(1), 9) == []
