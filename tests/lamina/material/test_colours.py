# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours instead of albedos: the albedo gives the colour, tested by the solver of bakes."""

import json
import math

import numpy as np
import pytest

import lamina
from lamina import (
    CornetteShanks,
    DoubleHenyeyGreenstein,
    HenyeyGreenstein,
    Isotropic,
    Lambert,
    Medium,
    Mixture,
    Rayleigh,
    Stack,
    StackError,
    Tabulated,
)
from lamina.colours import albedo_of, shown
from lamina.material import colours

PHASES = {
    "isotropic": Isotropic(),
    "forward": HenyeyGreenstein([0.3, 0.6, 0.8]),
    "narrow": HenyeyGreenstein(0.9),
    "backward": HenyeyGreenstein(-0.6),
    "rayleigh": Rayleigh(),
    "two lobes": DoubleHenyeyGreenstein(0.85, -0.3, 0.8),
    "cornette-shanks": CornetteShanks(0.5),
    "moments": Tabulated(moments=[1.0, 0.4, 0.2]),
    "mixture": Mixture([(0.5, Isotropic()), (0.5, HenyeyGreenstein(0.7))]),
}


def white_sky(albedo, tau, phase, over=0.0):
    """The colour by the solver as it bakes, at final quality."""
    solved = lamina.solve(Stack([Medium(albedo=albedo, tau=tau, phase=phase)], base=Lambert(over)), threads=1)
    return solved.reflectance("diffuse")


@pytest.mark.parametrize("phase", PHASES.values(), ids=PHASES)
def test_a_thick_layer_shows_its_colour(phase):
    colour = [0.02, 0.35, 0.93]
    albedo = albedo_of(colour, phase)
    np.testing.assert_allclose(white_sky(albedo, math.inf, phase), colour, rtol=1e-5)
    np.testing.assert_allclose(shown(Medium(albedo=albedo, tau=1.0, phase=phase)), colour, rtol=1e-5)


@pytest.mark.parametrize("phase", PHASES.values(), ids=PHASES)
@pytest.mark.parametrize("tau", [0.3, 4.0])
def test_a_layer_shows_its_colour_over_a_surface(phase, tau):
    over = [0.0, 0.2, 0.9]
    darkest, lightest = (np.array(shown(Medium(albedo=a, tau=tau, phase=phase), over)) for a in (0.0, 1.0))
    colour = darkest + [0.1, 0.5, 0.95] * (lightest - darkest)
    albedo = albedo_of(list(colour), phase, tau, over)
    np.testing.assert_allclose(white_sky(albedo, tau, phase, over), colour, rtol=1e-5)


def test_black_and_white_are_exact():
    for phase in PHASES.values():
        assert set(albedo_of(0.0, phase)) == {0.0} and set(albedo_of(1.0, phase)) == {1.0}
    assert shown(Medium(albedo=[0.0, 1.0], tau=2.0)) == [0.0, 1.0]
    assert shown(Medium(albedo=0.7, tau=0.0), over=0.3) == [0.3] and albedo_of(0.3, tau=0.0, over=0.3) == [0.0]


def test_the_ends_of_the_range_over_a_surface_are_exact():
    for end in (0.0, 1.0):
        colour = shown(Medium(albedo=end, tau=0.5), over=0.4)
        assert albedo_of(colour, tau=0.5, over=0.4) == [end]


@pytest.mark.parametrize("tau, over", [(math.inf, None), (1e-3, 0.0), (1.0, 0.5), (50.0, 0.1)])
def test_lighter_colours_need_larger_albedos(tau, over):
    phase = HenyeyGreenstein(0.5)
    low, high = (0.0, 1.0) if over is None else (shown(Medium(albedo=a, tau=tau, phase=phase), over)[0] for a in (0, 1))
    share = np.concatenate([[0.0, 1e-6, 1e-4], np.linspace(0.01, 0.99, 25), [1 - 1e-4, 1 - 1e-5, 1.0]])
    albedo = [albedo_of(low + x * (high - low), phase, tau, over)[0] for x in share]
    assert all(a < b for a, b in zip(albedo, albedo[1:], strict=False)) and albedo[0] == 0.0 and albedo[-1] == 1.0


@pytest.mark.parametrize("colour", [1e-7, 1e-4, 0.9999, 0.99999])
def test_colours_near_black_and_white(colour):
    assert white_sky(albedo_of(colour), math.inf, Isotropic())[0] == pytest.approx(colour, rel=1e-5)


def test_an_infinite_layer_hides_what_it_lies_over():
    assert albedo_of(0.6, tau=math.inf, over=0.1) == albedo_of(0.6)


def test_a_stack_shows_the_colour_of_its_medium():
    colour, phase = [0.6, 0.5, 0.2], HenyeyGreenstein(0.4)
    stack = Stack([Medium(color=colour, tau=2.0, over=0.5, phase=phase)], base=Lambert(0.5))
    np.testing.assert_allclose(lamina.solve(stack, threads=1).reflectance("diffuse"), colour, rtol=1e-5)
    assert [stack.optics(0, c)[0] for c in range(3)] == albedo_of(colour, phase, 2.0, 0.5)


def test_json_keeps_the_colour_and_the_hash_means_the_albedo():
    data = {"schema": 1, "layers": [{"kind": "medium", "color": [0.5, 0.4, 0.3], "over": 0.3, "tau": 1.0,
                                     "phase": {"kind": "isotropic"}}], "base": None}
    stack = Stack.from_json(data)
    assert stack.to_json() == data and "color" not in stack.canonical()
    albedo = [stack.optics(0, c)[0] for c in range(3)]
    assert stack.hash == Stack([Medium(albedo=albedo, tau=1.0)]).hash
    assert stack.hash == Stack.from_json(json.loads(stack.canonical())).hash
    assert stack.hash != Stack([Medium(color=[0.5, 0.4, 0.31], over=0.3, tau=1.0)]).hash


@pytest.mark.parametrize("layer, sentence", [
    ({"color": 1.2, "tau": 1.0}, "layers[0].color = 1.2: must lie in [0, 1]"),
    ({"color": [0.5, -1], "tau": 1.0}, "layers[0].color[1] = -1: must lie in [0, 1]"),
    ({"color": 0.5, "over": 2.0, "tau": 1.0}, "layers[0].over = 2: must lie in [0, 1]"),
    ({"color": 0.5}, "layers[0].tau is missing: must have either albedo, tau or sigma_s, sigma_a, thickness or "
                     "color, tau or pigment, amount, sigma_s, thickness"),
    ({"over": 0.5, "tau": 1.0}, "layers[0].color is missing: must have either albedo, tau or sigma_s, sigma_a, "
                                "thickness or color, tau or pigment, amount, sigma_s, thickness"),
    ({"color": 0.5, "albedo": 0.5, "tau": 1.0}, "layers[0] has two forms: must have either albedo, tau or sigma_s, "
                                                "sigma_a, thickness or color, tau or pigment, amount, "
                                                "sigma_s, thickness"),
    ({"color": [0.2, 0.2, 0.2], "tau": [1.0, 2.0]}, "layers[0].color has 3 channels: must have 2 like layers[0].tau"),
    ({"color": 0.9, "over": 0.2, "tau": 0.0}, "layers[0].color = 0.9: a layer of tau 0 over 0.2 shows 0.2"),
])
def test_bad_colours(layer, sentence):
    with pytest.raises(StackError) as caught:
        Stack([Medium(**layer)])
    assert str(caught.value) == sentence


def test_a_colour_out_of_reach_is_refused_with_the_range():
    with pytest.raises(StackError) as caught:
        Stack([Medium(albedo=1.0, tau=1.0), Medium(color=[0.2, 0.9, 0.2], over=0.2, tau=0.1)])
    low, high = (shown(Medium(albedo=a, tau=0.1), 0.2)[0] for a in (0.0, 1.0))
    least, most = math.ceil(low * 1e4) / 1e4, math.floor(high * 1e4) / 1e4
    assert str(caught.value) == (
        f"layers[1].color[1] = 0.9: a layer of tau 0.1 over 0.2 shows between {least} and {most}")
    # The ends given in the message are allowed.
    Stack([Medium(color=[least, most], over=0.2, tau=0.1)])


def test_shown_takes_every_form():
    assert shown(Medium(sigma_s=[3.0, 1.0], sigma_a=1.0, thickness=0.5)) == shown(Medium(albedo=[0.75, 0.5], tau=9.0))
    np.testing.assert_allclose(shown(Medium(color=[0.1, 0.5], tau=2.0)), [0.1, 0.5], rtol=1e-5)
    assert len(shown(Medium(albedo=0.5, tau=1.0), over=[0.1, 0.2, 0.3])) == 3


def test_a_profile_has_no_one_colour():
    """The core was given no albedo."""
    layered = Medium(tau=1.0, profile=[lamina.Knot(0.0, albedo=0.5), lamina.Knot(1.0, albedo=0.9)])
    with pytest.raises(StackError, match=r"^medium\.profile: must be left out"):
        shown(layered, over=0.2)


def test_a_stack_solves_for_its_colours_when_they_are_needed(monkeypatch):
    asked = []
    monkeypatch.setattr(colours, "albedo_by", lambda wanted, *situation: asked.append(wanted) or 0.5)
    stack = Stack([Medium(color=[0.31, 0.32, 0.33], tau=1.0), Medium(color=0.34, over=0.2, tau=9.0)])
    assert asked == []
    assert stack.optics(0, 1) == (0.5, 1.0)
    assert sorted(asked) == [0.31, 0.32, 0.33, 0.34, 0.34, 0.34]
    stack.canonical()
    assert len(asked) == 6
