# SPDX-License-Identifier: GPL-3.0-or-later
"""Descriptions and results can be keys: equal objects have equal hashes, however they were given."""

import pickle

import numpy as np
import pytest

import lamina
from lamina import (
    Conductor,
    HalfSpace,
    HenyeyGreenstein,
    Interface,
    Isotropic,
    Knot,
    Lambert,
    Medium,
    Mixture,
    PrincipledBase,
    Stack,
    Tabulated,
)

PAIRS = {
    "medium": lambda row: Medium(row([0.9, 0.8, 0.7]), row([1.0, 2.0, 3.0]), HenyeyGreenstein(row([0.1, 0.2, 0.3]))),
    "profile": lambda row: Medium(tau=1.0, profile=[Knot(0.0, row([0.1, 0.2, 0.3])), Knot(1.0, 0.5)]),
    "table": lambda row: Medium(0.9, 1.0, Tabulated(moments=row([1.0, 0.5, 0.25]))),
    "mixture": lambda row: Medium(0.9, 1.0, Mixture([[row([0.25, 0.5, 1.0]), Isotropic()],
                                                     [row([0.75, 0.5, 0.0]), HenyeyGreenstein(0.5)]])),
    "interface": lambda row: Interface(row([1.5, 1.51, 1.52]), 0.1),
}
BASES = {
    "lambert": lambda row: Lambert(row([0.5, 0.3, 0.1])),
    "conductor": lambda row: Conductor(row([0.2, 0.4, 1.3]), row([3.0, 2.0, 1.0])),
    "half-space": lambda row: HalfSpace(row([0.2, 0.4, 0.3]), HenyeyGreenstein(row([0.1, 0.2, 0.3]))),
    "principled": lambda row: PrincipledBase(row([0.2, 0.4, 0.3]), inputs=["color"]),
}


@pytest.mark.parametrize("make", [*PAIRS.values(), *BASES.values()], ids=[*PAIRS, *BASES])
def test_lists_arrays_and_tuples_are_equal(make):
    forms = [make(list), make(tuple), make(np.array)]
    assert len(set(forms)) == 1 and len({*forms, pickle.loads(pickle.dumps(forms[0]))}) == 1


@pytest.mark.parametrize("make", BASES.values(), ids=BASES)
def test_equal_stacks_have_equal_hashes(make):
    layers = [Interface(1.5, 0.1), Medium([0.9, 0.8, 0.7], 1.0)]
    stacks = [Stack(layers, make(form)) for form in (list, np.array)]
    stacks.append(Stack.from_json(stacks[0].to_json()))
    assert len(set(stacks)) == 1 and len({one.hash for one in stacks}) == 1
    assert Stack(layers, Lambert(0.123)) not in set(stacks)


def test_results_are_equal_by_content():
    slab = Stack([Medium(0.9, 1.0)])
    estimates = [lamina.estimate(slab, 0.5, 0.5, samples=4096, seed=seed) for seed in (1, 1, 2)]
    assert estimates[0] == estimates[1] != estimates[2] and len(set(estimates)) == 2
    assert pickle.loads(pickle.dumps(estimates[0])) in set(estimates)
    lut = lamina.bake(slab, "preview")
    assert lut == pickle.loads(pickle.dumps(lut)) and len({lut, pickle.loads(pickle.dumps(lut))}) == 1
    assert lut != lamina.Lut(lut.header, lut.weights * np.float32(2.0)) and lut != "another thing"
    inputs = [lamina.subsurface_inputs(albedo=albedo, distance=1.0) for albedo in (0.5, 0.5, 0.6)]
    assert len(set(inputs)) == 2
