# SPDX-License-Identifier: GPL-3.0-or-later
"""Lengths in millimetres: conversion of optical depth to depth, and stacks without lengths."""

import math

import pytest

import lamina
from lamina import HalfSpace, HenyeyGreenstein, Interface, Knot, Lambert, Medium, Stack, StackError
from lamina.material.millimetres import depth_knots, lengths_hash, require_millimetres


def test_knots_of_a_homogeneous_layer_and_of_a_half_space():
    stack = Stack([Interface(1.3), Medium(sigma_s=[1.0, 2.0], sigma_a=0.5, thickness=2.0)],
                  HalfSpace(sigma_s=0.0, sigma_a=3.0))
    boundary, layer, below = depth_knots(stack, 1)
    assert boundary == ()
    assert layer == ((0.0, 0.0, 2.5), (5.0, 2.0, 2.5))
    assert below == ((0.0, 0.0, 3.0), (math.inf, math.inf, 3.0))


def test_knots_of_a_profile_agree_with_the_optical_ones():
    """A ramp, a jump and an empty part."""
    layer = Medium(thickness=2.0, profile=[Knot(0.0, sigma_s=1.0, sigma_a=0.0), Knot(0.5, sigma_s=2.0, sigma_a=1.0),
                                           Knot(0.5, sigma_s=0.0, sigma_a=0.0), Knot(0.8, sigma_s=0.0, sigma_a=0.0),
                                           Knot(0.8, sigma_s=0.5, sigma_a=0.5), Knot(1.0, sigma_s=0.5, sigma_a=0.5)])
    stack = Stack([layer])
    knots = depth_knots(stack, 0)[0]
    assert [knot.tau for knot in knots] == pytest.approx([0.0, 2.0, 2.0, 2.0, 2.0, 2.4])
    assert [knot.depth for knot in knots] == pytest.approx([0.0, 1.0, 1.0, 1.6, 1.6, 2.0])
    assert knots[-1].tau == pytest.approx(stack.optics(0, 0)[1], rel=1e-14)


def test_a_half_space_by_coefficients_is_the_one_by_albedo():
    by_albedo = Stack(base=HalfSpace(0.75, HenyeyGreenstein(0.4)))
    by_coefficients = Stack(base=HalfSpace(sigma_s=3.0, sigma_a=1.0, phase=HenyeyGreenstein(0.4)))
    assert by_albedo.hash == by_coefficients.hash
    assert Stack.from_json(by_coefficients.to_json()) == by_coefficients
    assert lamina.solve(by_coefficients, nodes=16).reflectance(0.7)[0] == \
        lamina.solve(by_albedo, nodes=16).reflectance(0.7)[0]


def test_the_hash_of_lengths_knows_the_scale():
    thin, thick = (Stack([Medium(sigma_s=1.0 / scale, sigma_a=0.0, thickness=scale)]) for scale in (1.0, 2.0))
    assert thin.hash == thick.hash and lengths_hash(thin) != lengths_hash(thick)


@pytest.mark.parametrize(("stack", "sentence"), [
    (Stack([Medium(albedo=0.9, tau=1.0)]), "layers[0]: has no lengths, must have"),
    (Stack([Interface(1.5), Medium(color=0.9, tau=1.0)], Lambert(0.5)), "layers[1]: has no lengths, must have"),
    (Stack([Medium(tau=1.0, profile=[Knot(0.0, 0.9), Knot(1.0, 0.5)])]), "layers[0]: has no lengths, must have"),
    (Stack(base=HalfSpace(0.9)), "base: has no lengths, must have"),
    (Stack(base=HalfSpace(sigma_s=0.0, sigma_a=[1.0, 0.0])), "base.sigma_s = 0: an infinitely thick medium must"),
    (Stack([Medium(sigma_s=[0.0, 1.0], sigma_a=0.0, thickness=math.inf)]),
     "layers[0].thickness = inf: an infinitely thick medium"),
])
def test_what_tells_no_length_is_refused(stack, sentence):
    with pytest.raises(StackError) as refused:
        require_millimetres(stack)
    assert str(refused.value).startswith(sentence) and "\n" not in str(refused.value)


def test_a_half_space_has_one_form():
    with pytest.raises(StackError, match="base has two forms: must have either albedo or sigma_s, sigma_a"):
        Stack(base=HalfSpace(0.9, sigma_s=1.0, sigma_a=1.0))
    with pytest.raises(StackError, match="base has no coefficients"):
        Stack(base=HalfSpace())
