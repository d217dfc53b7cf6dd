# SPDX-License-Identifier: GPL-3.0-or-later
"""A share of `make fuzz`: what holds for all stacks holds for these, and none is refused for what it costs."""

import pytest
import run

SEED, COUNT = 7, 60


@pytest.mark.parametrize("number", range(COUNT))
def test_a_random_stack(number):
    # Every tenth is baked and held against photon walks too.
    chosen = number % 10 == 0
    found = run.examine(SEED, number, comparisons=COUNT, walked=chosen, baked=chosen)
    assert not found["wrong"], found["wrong"]
