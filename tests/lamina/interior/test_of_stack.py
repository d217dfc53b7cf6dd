# SPDX-License-Identifier: GPL-3.0-or-later
"""The interior of a body that a stack with one medium fills."""

import numpy as np
import pytest

import lamina
from lamina import HalfSpace, HenyeyGreenstein, Interface, Lambert, Medium, Stack, StackError, Surface


def test_a_preset_with_a_boundary():
    interior, surface = lamina.interior_of_stack(lamina.presets.load("marble-honed"))
    (material,) = interior.palette
    assert (material.sigma_s, material.sigma_a, material.g) == ((2.19, 2.62, 3.0), (0.0021, 0.0041, 0.0071), 0.0)
    assert surface == Surface(1.5, 0.35)


def test_a_layer_of_one_channel():
    interior, surface = lamina.interior_of_stack(Stack([Medium(sigma_s=2.0, sigma_a=0.5, thickness=3.0)]))
    assert interior.palette[0].sigma_s == (2.0,) * 3 and surface == Surface()


def test_channels_with_different_g_keep_their_reduced_scattering():
    medium = HalfSpace(sigma_s=[1.0, 2.0, 3.0], sigma_a=0.1, phase=HenyeyGreenstein([0.2, 0.5, 0.8]))
    (material,) = lamina.interior_of_stack(Stack([], base=medium))[0].palette
    assert material.g == pytest.approx(0.5)
    assert [s * 0.5 for s in material.sigma_s] == pytest.approx([0.8, 1.0, 0.6])


@pytest.mark.parametrize(("stack", "words"), [
    (Stack([Medium(albedo=0.5, tau=1.0)]), "has no lengths"),
    (Stack([Medium(sigma_s=1.0, sigma_a=0.0, thickness=1.0)], base=Lambert(0.5)), "must be one homogeneous medium"),
    (Stack([Interface(1.5), Interface(1.3), Medium(sigma_s=1.0, sigma_a=0.0, thickness=1.0)]), "at most one interface"),
    (Stack([Medium(sigma_s=1.0, sigma_a=0.0, thickness=1.0, phase=lamina.Rayleigh())]), "phase: must be isotropic or"),
])
def test_other_stacks_are_refused(stack, words):
    with pytest.raises(StackError, match=words):
        lamina.interior_of_stack(stack)


def test_an_infinite_medium_hides_the_rest():
    deep, other = (Medium(sigma_s=(2.0, 1.0, 0.5), sigma_a=0.01, thickness=thickness) for thickness in (np.inf, 1.0))
    alone, below = (lamina.interior_of_stack(stack)[0] for stack in (Stack([deep]), Stack([deep, other], Lambert(0.2))))
    assert alone.hash == below.hash
