# SPDX-License-Identifier: GPL-3.0-or-later
"""A solved stack with another thickness is the solved other stack, and knows this stack."""

import math
import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import lamina
from lamina import HalfSpace, HenyeyGreenstein, Interface, Knot, Lambert, Medium, Stack

HG = HenyeyGreenstein(0.5)
BASE = Lambert([0.5, 0.3, 0.1])
# (layers, index of the layer, new thicknesses, the layer that the new stack should have)
CASES = {
    "channels": ([Medium([0.9, 0.8, 0.6], [1.0, 2.0, 3.0], HG)], 0, [0.5, 0.2, 4.0],
                 Medium([0.9, 0.8, 0.6], [0.5, 0.2, 4.0], HG)),
    "number": ([Medium([0.9, 0.8, 0.6], [1.0, 2.0, 3.0])], 0, 0.7, Medium([0.9, 0.8, 0.6], 0.7)),
    "below varnish": ([Interface(1.5, 0.1), Medium(0.9, [1.0, 2.0, 3.0])], 1, [3.0, 2.0, 1.0],
                      Medium(0.9, [3.0, 2.0, 1.0])),
    "millimetres": ([Medium(sigma_s=[4.0, 5.0, 6.0], sigma_a=[0.5, 0.1, 1.0], thickness=0.2)], 0, [0.9, 1.02, 1.4],
                    Medium(sigma_s=[4.0, 5.0, 6.0], sigma_a=[0.5, 0.1, 1.0], thickness=0.2)),
    "endless": ([Medium(0.9, [1.0, 2.0, 3.0])], 0, math.inf, Medium(0.9, math.inf)),
    "color": ([Medium(color=[0.5, 0.4, 0.3], tau=1.0)], 0, [2.0, 3.0, 4.0],
              Medium(color=[0.5, 0.4, 0.3], tau=[2.0, 3.0, 4.0])),
    "profile": ([Medium(tau=2.0, profile=[Knot(0.0, 0.9, HG), Knot(1.0, [0.7, 0.5, 0.3])])], 0, [1.0, 0.5, 3.0],
                Medium(tau=[1.0, 0.5, 3.0], profile=[Knot(0.0, 0.9, HG), Knot(1.0, [0.7, 0.5, 0.3])])),
    "profile of nothing": ([Medium(tau=0.0, profile=[Knot(0.0, 0.9, HG), Knot(1.0, [0.7, 0.5, 0.3])])], 0, 1.5,
                           Medium(tau=1.5, profile=[Knot(0.0, 0.9, HG), Knot(1.0, [0.7, 0.5, 0.3])])),
}
MU_O, MU_I, DPHI = np.array([0.3, 0.7, 1.0]), np.array([0.9, 0.4, 0.6]), np.array([0.0, 1.0, 3.0])


def values(function):
    return np.concatenate([function.brdf(MU_O, MU_I, DPHI).ravel(), function.reflectance(MU_O).ravel()])


@pytest.mark.parametrize("name", CASES)
def test_the_function_is_that_of_its_stack(name):
    layers, layer, taus, expected = CASES[name]
    changed = lamina.solve(Stack(layers, BASE)).with_thickness(layer, taus)
    wanted = Stack([expected if number == layer else one for number, one in enumerate(layers)], BASE)
    assert changed.stack.layers[layer].checked("") == expected.checked("")
    assert changed.stack.hash == wanted.hash
    assert values(changed) == pytest.approx(values(lamina.solve(wanted)), rel=2e-3)
    assert values(pickle.loads(pickle.dumps(changed))).tobytes() == values(changed).tobytes()


def test_lengths_follow_the_thickness():
    """In millimetres: one thickness where the optical thicknesses keep their ratio, else one per channel."""
    medium = Medium(sigma_s=[4.0, 5.0, 6.0], sigma_a=[0.5, 0.0, 1.0], thickness=0.2)
    solved = lamina.solve(Stack([medium], BASE), "preview")
    assert solved.with_thickness(0, [2.25, 2.5, 3.5]).stack.layers[0].thickness == pytest.approx(0.5)
    assert solved.with_thickness(0, 1.0).stack.layers[0].thickness == pytest.approx((1 / 4.5, 1 / 5.0, 1 / 7.0))
    graded = Medium(thickness=1.0, profile=[Knot(0.0, sigma_s=1.0, sigma_a=0.0), Knot(1.0, sigma_s=3.0, sigma_a=0.0)])
    changed = lamina.solve(Stack([graded], BASE), "preview").with_thickness(0, 5.0).stack
    assert changed.layers[0].thickness == pytest.approx(2.5) and changed.optics(0, 0)[1] == pytest.approx(5.0)


def test_a_color_over_a_base_keeps_its_albedo():
    """The color was that of the layer with its first thickness; another thickness shows another color."""
    medium = Medium(color=[0.5, 0.4, 0.3], over=0.8, tau=1.0)
    stack = Stack([medium], BASE)
    changed = lamina.solve(stack).with_thickness(0, 2.0)
    assert [changed.stack.optics(0, c) for c in range(3)] == [(stack.optics(0, c)[0], 2.0) for c in range(3)]
    assert values(changed) == pytest.approx(values(lamina.solve(changed.stack)), rel=2e-3)


def test_one_channel_becomes_three():
    gray = Stack([Medium(0.9, 1.0, HG)], Lambert(0.3), name="Grey")
    changed = lamina.solve(gray).with_thickness(0, [0.5, 1.0, 2.0])
    assert changed.stack.channels == 3 == changed.reflectance(0.5).shape[-1] and changed.stack.name == "Grey"
    assert values(changed) == pytest.approx(values(lamina.solve(changed.stack)), rel=2e-3)
    again = changed.with_thickness(0, [2.0, 2.0, 0.1])
    assert values(again) == pytest.approx(values(lamina.solve(again.stack)), rel=2e-3)


def test_a_base_of_another_reflectance_is_in_the_stack():
    changed = lamina.solve(Stack([Medium(0.9, [1.0, 2.0, 3.0])], BASE)).with_base_reflectance(0.7)
    assert changed.stack.base == Lambert(0.7) and changed.stack.channels == 3
    assert values(changed) == pytest.approx(values(lamina.solve(changed.stack)), rel=2e-3)


def test_what_varies_still_varies():
    dust = Stack([Medium(0.9, 1.0, varying=True)], HalfSpace(0.3))
    assert lamina.solve(dust, "preview").with_thickness(0, 0.5).stack.varying == 0
    assert lamina.solve(dust, "preview").with_thickness(0, math.inf).stack.varying is None


def test_a_clear_medium_has_no_optical_thickness():
    water = Stack([Medium(sigma_s=[0.0, 1.0, 1.0], sigma_a=0.0, thickness=2.0)], BASE)
    with pytest.raises(lamina.ArgumentError, match=r"taus\[0\] = 1: must be 0 in a channel where the medium neither"):
        lamina.solve(water, "preview").with_thickness(0, [1.0, 1.0, 1.0])
    assert lamina.solve(water, "preview").with_thickness(0, [0.0, 1.0, 1.0]).stack.optics(0, 0)[1] == 0.0


def test_several_threads_at_once():
    """Azimuth orders are added for the thicker media, which all share them."""
    solved = lamina.solve(Stack([Medium(0.99, 2e-5, HenyeyGreenstein(0.95))], Lambert(0.3)), "preview")
    thicknesses = (0.1, 0.2, 0.3, 0.15)
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda tau: solved.with_thickness(0, tau), thicknesses))
    for one, tau in zip(found, thicknesses, strict=True):
        again = lamina.solve(Stack([Medium(0.99, 2e-5, HenyeyGreenstein(0.95))], Lambert(0.3)), "preview")
        np.testing.assert_array_equal(values(one), values(again.with_thickness(0, tau)))
