# SPDX-License-Identifier: GPL-3.0-or-later
"""Profiles of media: the meaning of knots, and errors of bad ones."""

import numpy as np
import pytest

import lamina
from lamina import Black, HenyeyGreenstein, Knot, Medium, Rayleigh, Stack, StackError

ENDS = [Knot(0.0, albedo=0.9, phase=HenyeyGreenstein(0.5)), Knot(1.0, albedo=0.5)]


def medium(*knots, **values):
    return Medium(**({"tau": 2.0} | values), profile=knots)


BAD = {
    "albedo": (medium(ENDS[0], Knot(1.0, albedo=1.2)), "layers[0].profile[1].albedo = 1.2: must lie in [0, 1]"),
    "depth": (medium(ENDS[0], Knot(1.5, albedo=0.2)), "layers[0].profile[1].depth = 1.5: must lie in [0, 1]"),
    "list of depths": (medium(Knot([0.0, 0.1], albedo=0.2), ENDS[1]),
                       "layers[0].profile[0].depth = [0.0, 0.1]: must be one number"),
    "first": (medium(Knot(0.1, albedo=0.2), ENDS[1]), "layers[0].profile[0].depth = 0.1: must be 0"),
    "last": (medium(ENDS[0], Knot(0.9, albedo=0.2)), "layers[0].profile[1].depth = 0.9: must be 1"),
    "descends": (medium(ENDS[0], Knot(0.6, 0.1), Knot(0.5, 0.1), ENDS[1]),
                 "layers[0].profile[2].depth = 0.5: must be at least 0.6, that of the knot above"),
    "jump at the top": (medium(ENDS[0], Knot(0.0, 0.1), ENDS[1]),
                        "layers[0].profile[1].depth = 0: must be larger than that of the knot above"),
    "three at one depth": (medium(ENDS[0], *[Knot(0.5, 0.1)] * 3, ENDS[1]),
                           "layers[0].profile[3].depth = 0.5: must be larger than that of the knot above"),
    "one knot": (medium(ENDS[0]), "layers[0].profile has 1: must be a list of two knots or more, top first"),
    "no list": (Medium(tau=1.0, profile=0.5),
                "layers[0].profile = 0.5: must be a list of two knots or more, top first"),
    "no knot": (medium(ENDS[0], 0.5), "layers[0].profile[1] = 0.5: must be a Knot"),
    "empty knot": (medium(ENDS[0], Knot(1.0)),
                   "layers[0].profile[1] has no coefficients: must have either albedo or sigma_s, sigma_a or color"),
    "mixed": (medium(ENDS[0], Knot(1.0, sigma_s=1.0, sigma_a=1.0)),
              "layers[0].profile[1]: must have albedo or color like the first knot"),
    "half": (medium(Knot(0.0, sigma_s=1.0), Knot(1.0, sigma_s=1.0, sigma_a=1.0)),
             "layers[0].profile[0].sigma_a is missing: must have either albedo or sigma_s, sigma_a or color"),
    "albedo twice": (medium(*ENDS, albedo=0.5),
                     "layers[0].albedo: must be left out of a medium with a profile, whose knots have it"),
    "endless": (medium(*ENDS, tau="inf"), "layers[0].tau = inf: must lie in [0, 1e9] for a medium with a profile"),
    "no tau": (medium(*ENDS, tau=None), "layers[0].tau is missing: must be given with a profile of such knots"),
    "thickness": (medium(*ENDS, thickness=1.0),
                  "layers[0].thickness: must be left out, the profile's knots go with tau"),
    "over": (medium(*ENDS, over=0.5), "layers[0].over: must be left out where no knot has a color"),
    "phase": (medium(ENDS[0], Knot(1.0, albedo=0.5, phase=HenyeyGreenstein(1.0))),
              "layers[0].profile[1].phase.g = 1: must lie in [-0.964, 0.964]"),
    "channels": (medium(Knot(0.0, albedo=[0.1, 0.2]), Knot(1.0, albedo=[0.1, 0.2, 0.3])),
                 "layers[0].profile[1].albedo has 3 channels: must have 2 like layers[0].profile[0].albedo"),
    "colour": (medium(Knot(0.0, color=0.99), ENDS[1], over=0.0), None),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_profiles(name):
    layer, sentence = BAD[name]
    with pytest.raises(StackError) as caught:
        Stack([layer])
    if sentence is None:
        assert str(caught.value).startswith("layers[0].profile[0].color = 0.99: a layer of tau 2 over 0 shows between")
    else:
        assert str(caught.value) == sentence


@pytest.mark.parametrize("entry, sentence", [
    ({"depth": 0.0, "albedo": 0.5, "colour": 1.0}, "layers[0].profile[0].colour: unknown key; known are albedo, color, "
                                                   "depth, phase, sigma_a, sigma_s"),
    ({"albedo": 0.5}, "layers[0].profile[0].depth is missing: must be given"),
    ({"depth": "top", "albedo": 0.5}, "layers[0].profile[0].depth = 'top': must be a number or one number per channel"),
    ({"depth": 0.0, "albedo": 0.5, "phase": {"kind": "mie"}}, None),
    (7, "layers[0].profile[0] = 7: must be a JSON object"),
])
def test_bad_json(entry, sentence):
    with pytest.raises(StackError) as caught:
        Stack.from_json({"schema": 1, "layers": [{"kind": "medium", "tau": 1.0, "profile": [entry, entry]}]})
    assert str(caught.value) == sentence or sentence is None
    with pytest.raises(StackError, match=r"layers\[0\].profile = 3: must be a list"):
        Stack.from_json({"schema": 1, "layers": [{"kind": "medium", "tau": 1.0, "profile": 3}]})


def test_a_knots_phase_is_the_mediums_where_none_is_given():
    said = Stack([medium(Knot(0.0, 0.9, Rayleigh()), Knot(1.0, 0.5, Rayleigh()))])
    left_out = Stack([medium(Knot(0.0, 0.9), Knot(1.0, 0.5), phase=Rayleigh())])
    assert said.hash == left_out.hash
    assert said.hash != Stack([medium(Knot(0.0, 0.9), Knot(1.0, 0.5))]).hash


def test_knots_in_optical_depth():
    stack = Stack([Medium(tau=[2.0, 4.0], profile=[Knot(0.0, 0.9), Knot(0.25, [0.5, 0.6]), Knot(1.0, 0.1)])])
    assert stack.knots(0, 1) == [(0.0, 0.9, ("isotropic",)), (1.0, 0.6, ("isotropic",)), (4.0, 0.1, ("isotropic",))]
    assert stack.optics(0, 1) == (pytest.approx((0.75 * 1.0 + 0.35 * 3.0) / 4.0), 4.0)


@pytest.mark.parametrize("below", [(2.0, 0.8), (0.1, 0.0), (0.0, 0.0), (1.0, 29.0)])
def test_coefficients_linear_in_millimetres(below):
    """The albedo along the knots against sigma_s / sigma_t at the same place."""
    ends = [Knot(0.0, sigma_s=1.0, sigma_a=0.2), Knot(1.0, sigma_s=below[0], sigma_a=below[1])]
    knots = Stack([Medium(thickness=1.5, profile=ends)]).knots(0, 0)
    depth = np.linspace(0.0, 0.999, 5001)
    sigma_s = 1.0 + depth * (below[0] - 1.0)
    slope = sum(below) - 1.2
    tau = 1.5 * (1.2 * depth + 0.5 * slope * depth**2)
    found = np.interp(tau, [knot[0] for knot in knots], [knot[1] for knot in knots])
    assert np.abs(found - sigma_s / (1.2 + slope * depth)).max() < 1e-4
    assert knots[-1][0] == pytest.approx(1.5 * (1.2 + 0.5 * slope))


def test_phase_functions_mix_by_what_they_scatter():
    ends = [Knot(0.0, sigma_s=3.0, sigma_a=0.0, phase=HenyeyGreenstein(0.5)), Knot(1.0, sigma_s=1.0, sigma_a=0.0)]
    knots = Stack([Medium(thickness=1.0, profile=ends)]).knots(0, 0)
    assert knots[0][2] == ("hg", 0.5) and knots[-1][2] == ("isotropic",)
    for tau, albedo, phase in knots[1:-1]:
        # e^2 = e0^2 + 2 (e1 - e0) tau where e, here sigma_s, is linear.
        sigma = np.sqrt(9.0 - 4.0 * tau)
        assert albedo == pytest.approx(1.0) and phase[1] == (pytest.approx(1.5 * (sigma - 1.0) / sigma), ("hg", 0.5))


def test_knots_by_colour():
    """Each has the albedo with which a homogeneous layer shows the colour."""
    stack = Stack([Medium(tau=2.0, over=0.1, profile=[Knot(0.0, color=0.4), Knot(1.0, albedo=0.3)])], Black())
    alone = Stack([Medium(tau=2.0, over=0.1, color=0.4)])
    assert stack.knots(0, 0)[0][1] == alone.optics(0, 0)[0] and stack.knots(0, 0)[1][1] == 0.3


def test_nothing_between_knots():
    assert lamina.solve(Stack([medium(*ENDS, tau=0.0)]), threads=1).reflectance(0.5)[0] == 0.0
