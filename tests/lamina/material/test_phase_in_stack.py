# SPDX-License-Identifier: GPL-3.0-or-later
"""Phase functions in stacks: reading, refusal, writing, hashes and values for the core."""

import json
import math
import random

import numpy as np
import pytest
from drawn_kinds import drawn

from lamina import (
    CornetteShanks,
    DoubleHenyeyGreenstein,
    Draine,
    HalfSpace,
    HenyeyGreenstein,
    Isotropic,
    Medium,
    Mixture,
    Rayleigh,
    Stack,
    StackError,
    Tabulated,
)
from lamina.kinds import phases

COSINES = (-1.0, 0.0, 0.5, 1.0)
ONE_CHANNEL = [
    Isotropic(),
    Rayleigh(),
    CornetteShanks(0.5),
    Tabulated(moments=[1.0, 0.3, 0.1]),
    Tabulated(cosines=COSINES, values=[1.0, 2.0, 3.0, 9.0]),
]
THREE_CHANNELS = [
    HenyeyGreenstein([0.1, 0.2, 0.3]),
    DoubleHenyeyGreenstein(0.8, [-0.4, -0.3, -0.2], 0.9),
    Draine([0.6, 0.7, 0.8], 2.0),
    Tabulated(moments=[[1.0, 0.3, 0.1], [1.0, 0.2], [1.0]]),
    Tabulated(cosines=COSINES, values=[[1.0, 2.0, 3.0, 9.0], [1.0, 1.0, 1.0, 2.0], [1.0, 1.0, 1.0, 1.0]]),
    Mixture([(0.3, HenyeyGreenstein([0.1, 0.2, 0.3])), ([0.7, 0.7, 0.7], Tabulated(moments=[1.0, 0.3]))]),
]
ONE_CHANNEL += [drawn(cls, random.Random(1)) for cls in phases.KINDS
                if cls not in set(map(type, ONE_CHANNEL + THREE_CHANNELS))]
ALL = ONE_CHANNEL + THREE_CHANNELS


def stack(phase):
    return Stack([Medium(albedo=0.9, tau=1.0, phase=phase)], base=HalfSpace(0.5, phase))


@pytest.mark.parametrize("phase", ALL, ids=lambda phase: phase.kind)
def test_json_and_back(phase):
    whole = stack(phase)
    again = Stack.from_json(json.loads(json.dumps(whole.to_json())))
    assert again == whole and again.hash == whole.hash
    # The canonical form is itself a stack, of the same name.
    assert Stack.from_json(json.loads(whole.canonical())).hash == whole.hash


@pytest.mark.parametrize("one, other", [
    (HenyeyGreenstein(0.5), HenyeyGreenstein([0.5, 0.5, 0.5])),
    (Draine(0.5, 1.0), Draine([0.5, 0.5, 0.5], [1.0, 1.0, 1.0])),
    (Tabulated(moments=[1.0, 0.2]), Tabulated(moments=np.array([[1.0, 0.2]] * 3))),
    (Tabulated(cosines=COSINES, values=[1, 2, 3, 9]), Tabulated(cosines=COSINES[::-1], values=[[9, 3, 2, 1]] * 3)),
    (Mixture([(1.0, Rayleigh())]), Mixture([([1.0, 1.0, 1.0], Rayleigh())])),
], ids=lambda phase: phase.kind)
def test_one_matter_has_one_name(one, other):
    def coloured(phase):
        return Stack([Medium(albedo=[0.9, 0.8, 0.7], tau=1.0, phase=phase)])

    assert coloured(one).hash == coloured(other).hash


def test_names_of_other_matter_differ():
    assert len({stack(phase).hash for phase in ALL}) == len(ALL)


def test_the_names_of_simple_stacks_stay():
    """Hashes identify bakes that users store."""
    slab = Medium(albedo=[0.9, 0.8, 0.7], tau=1.0, phase=HenyeyGreenstein(0.5))
    text = Stack([slab], base=HalfSpace(0.5)).canonical()
    assert text == (
        '{"base": {"albedo": [0.5, 0.5, 0.5], "kind": "half-space", "phase": {"kind": "isotropic"}}, "layers": '
        '[{"albedo": [0.9, 0.8, 0.7], "kind": "medium", "phase": {"g": [0.5, 0.5, 0.5], "kind": "hg"}, '
        '"tau": [1.0, 1.0, 1.0], "varying": false}], "schema": 1}')


@pytest.mark.parametrize("phase", ALL, ids=lambda phase: phase.kind)
def test_channels(phase):
    assert stack(phase).channels == (1 if phase in ONE_CHANNEL else 3)
    assert stack(phase).layers[0].phase.in_channel(0)[0] in {
        phase.kind, *(("moments", "samples") if phase.kind == "tabulated" else ())}


@pytest.mark.parametrize("phase, words", [
    (DoubleHenyeyGreenstein(1.2, 0.0, 0.5), "layers[0].phase.g1 = 1.2: must lie in [-0.964, 0.964]"),
    (DoubleHenyeyGreenstein(0.5, [0.0, -1.0], 0.5), "layers[0].phase.g2[1] = -1: must lie in [-0.964, 0.964]"),
    (DoubleHenyeyGreenstein(0.5, 0.0, -0.1), "layers[0].phase.weight = -0.1: must lie in [0, 1]"),
    (Draine(math.nan, 1.0), "layers[0].phase.g = nan: must lie in [-0.964, 0.964]"),
    (Draine(0.5, -1.0), "layers[0].phase.alpha = -1: must lie in [0, 1000]"),
    (Draine(0.5, math.inf), "layers[0].phase.alpha = inf: must lie in [0, 1000]"),
    (CornetteShanks("much"), "layers[0].phase.g = 'much': must be a number or one number per channel"),
    (Tabulated(), "layers[0].phase has no numbers: must have either moments, or cosines and values"),
    (Tabulated(moments=[1.0], values=[1.0]),
     "layers[0].phase has moments and values: must have either moments, or cosines and values"),
    (Tabulated(moments=[]), "layers[0].phase.moments has 0 entries: must be a list of 1 to 2048 numbers, or one list "
     "per channel"),
    (Tabulated(moments=0.5),
     "layers[0].phase.moments = 0.5: must be a list of 1 to 2048 numbers, or one list per channel"),
    (Tabulated(moments=[0.9, 0.5]), "layers[0].phase.moments[0] = 0.9: must be 1"),
    (Tabulated(moments=[1.0, 1.5]), "layers[0].phase.moments[1] = 1.5: must lie in [-1, 1]"),
    (Tabulated(moments=[1.0, None]), "layers[0].phase.moments[1] = None: must be a number"),
    (Tabulated(moments=[[1.0], [1.0, math.nan]]), "layers[0].phase.moments[1][1] = nan: must lie in [-1, 1]"),
    (Tabulated(moments=[[1.0], 2.0]), "layers[0].phase.moments[1]: must be a list of numbers"),
    (Tabulated(moments=[1.0, 0.5]),
     "layers[0].phase.moments: their series is -0.5 at 180.0 degrees: must not be negative"),
    (Tabulated(cosines=[-1, 1], values=[1.0, -2.0]), "layers[0].phase.values[1] = -2: must lie in [0, 1e12]"),
    (Tabulated(cosines=[-1, 1], values=[0.0, 0.0]), "layers[0].phase.values: all values are 0: one must be positive"),
    (Tabulated(cosines=[-1, 0, 1], values=[[1, 1, 1], [1, 1]]),
     "layers[0].phase.values[1] has 2 values: must have 3, one per cosine"),
    (Tabulated(cosines=[-1, 0.5, 0.5, 1], values=[1, 1, 1, 1]),
     "layers[0].phase.cosines hold 0.5 next to 0.5: must rise or fall throughout"),
    (Tabulated(cosines=[-0.9, 1], values=[1, 1]),
     "layers[0].phase.cosines run from -0.9 to 1: must reach from -1 to 1"),
    (Tabulated(cosines=[[-1, 1]], values=[1, 1]), "layers[0].phase.cosines[0] is a list: must be a number"),
    (Mixture([]), "layers[0].phase.parts = []: must be a list of pairs (share, phase function)"),
    (Mixture([0.5]), "layers[0].phase.parts[0] = 0.5: must be a pair (share, phase function)"),
    (Mixture([(0.5, Isotropic())]), "layers[0].phase.parts have shares that sum to 0.5: must sum to 1"),
    (Mixture([(1.0, HenyeyGreenstein(3.0))]), "layers[0].phase.parts[0].phase.g = 3: must lie in [-0.964, 0.964]"),
    (Mixture([(0.5, Isotropic()), (-0.5, Isotropic())]),
     "layers[0].phase.parts[1].share = -0.5: must lie in [0, 1]"),
    (Mixture([(1.0, Mixture([(1.0, Isotropic())]))]),
     "layers[0].phase.parts[0].phase.kind = 'mixture': must not be a mixture itself"),
    (Mixture([(1.0, "fog")]), "layers[0].phase.parts[0].phase = 'fog': must be a phase function"),
    (Mixture([([0.5, 0.5], Isotropic()), ([0.5, 0.4], Isotropic())]),
     "layers[0].phase.parts have shares that sum to 0.9: must sum to 1"),
    (Mixture([([0.5, 0.5], HenyeyGreenstein([0.1, 0.2, 0.3])), (0.5, Isotropic())]),
     "layers[0].phase.parts[0].phase.g has 3 channels: must have 2 like layers[0].phase.parts[0].share"),
    ("fog", "layers[0].phase = 'fog': must be a phase function"),
], ids=str)
def test_refused(phase, words):
    with pytest.raises(StackError) as error:
        stack(phase)
    assert str(error.value) == words


@pytest.mark.parametrize("entry, words", [
    ({"kind": "fog"}, "layers[0].phase.kind = 'fog': must be one of "
     f"{', '.join(cls.kind for cls in phases.KINDS)}, tabulated, mixture"),
    ({"kind": "draine", "g": 0.5}, "layers[0].phase.alpha is missing: must be given"),
    ({"kind": "double-hg", "g1": 0, "g2": 0, "weight": 0, "g": 0},
     "layers[0].phase.g: unknown key; known are g1, g2, kind, weight"),
    ({"kind": "tabulated", "angles": []},
     "layers[0].phase.angles: unknown key; known are cosines, kind, moments, values"),
    ({"kind": "mixture"}, "layers[0].phase.parts is missing: must be given"),
    ({"kind": "mixture", "parts": {}}, "layers[0].phase.parts = {}: must be a list"),
    ({"kind": "mixture", "parts": [{"share": 1.0}]}, "layers[0].phase.parts[0].phase is missing: must be given"),
    ({"kind": "mixture", "parts": [{"share": 1.0, "phase": {"kind": "hg", "g": 2}}]},
     "layers[0].phase.parts[0].phase.g = 2: must lie in [-0.964, 0.964]"),
], ids=str)
def test_refused_in_json(entry, words):
    with pytest.raises(StackError) as error:
        Stack.from_json({"schema": 1, "layers": [{"kind": "medium", "albedo": 0.9, "tau": 1.0, "phase": entry}]})
    assert str(error.value) == words
