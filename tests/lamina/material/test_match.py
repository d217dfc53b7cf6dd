# SPDX-License-Identifier: GPL-3.0-or-later
"""The medium that shows two colours."""

import math

import numpy as np
import pytest

import lamina
from lamina import HenyeyGreenstein, Lambert, Medium, Rayleigh, Stack, StackError
from lamina.colours import match, match_coats

WHITE_SKY = np.polynomial.legendre.leggauss(40)


def seen(medium, over):
    """The colour under a white sky, by the final solver."""
    solved = lamina.solve(Stack([medium], Lambert(over)))
    mu, weight = 0.5 * (WHITE_SKY[0] + 1.0), 0.5 * WHITE_SKY[1]
    return 2.0 * ((weight * mu)[:, None] * solved.reflectance(mu)).sum(axis=0)


@pytest.mark.parametrize(("albedo", "tau", "phase"), [
    (0.8, 1.0, None), (0.99, 0.3, HenyeyGreenstein(0.6)), (0.3, 2.0, Rayleigh()), (0.999, 8.0, HenyeyGreenstein(0.8)),
    (0.95, 0.05, None), ((0.9, 0.5, 0.2), (3.0, 0.4, 0.8), HenyeyGreenstein((0.1, 0.5, -0.3))),
])
def test_a_layer_is_found_again(albedo, tau, phase):
    """From its colours by another path: the solver of all directions."""
    medium = Medium(albedo, tau, **({} if phase is None else {"phase": phase}))
    dark, bright = seen(medium, 0.0), seen(medium, 0.8)
    found = match(dark, bright, phase)
    assert np.array(found.albedo) == pytest.approx(np.array(albedo), abs=2e-4)
    assert np.array(found.tau) == pytest.approx(np.array(tau), rel=2e-3)
    again = Medium(found.albedo, found.tau, **({} if phase is None else {"phase": phase}))
    assert seen(again, 0.0) == pytest.approx(dark, abs=1e-5) and seen(again, 0.8) == pytest.approx(bright, abs=1e-5)


def test_an_opaque_layer_is_infinitely_thick():
    found = match([0.4, 0.2], [0.4, 0.5])
    assert found.tau[0] == math.inf and found.tau[1] < 2.0
    assert lamina.colours.shown(Medium(found.albedo[0], math.inf)) == pytest.approx([0.4], rel=1e-5)


def test_another_white():
    medium = Medium(0.9, 0.7)
    found = match(*(lamina.colours.shown(medium, over) for over in (0.0, 0.5)), white=0.5)
    assert (found.albedo, found.tau) == (pytest.approx(0.9, abs=1e-6), pytest.approx(0.7, rel=1e-5))


@pytest.mark.parametrize(("dark", "bright", "sentence"), [
    (0.5, 0.4, "over_black[0] = 0.5: must be at most over_white, 0.4"),
    ([0.1, 0.3], [0.5, 0.9], "over_black[1] = 0.3: a layer that shows 0.9 over 0.8 shows at least 0.8333 over black"),
    (1.2, 0.4, "over_black = 1.2: must lie in [0, 1]"),
    ([0.1, 0.2], [0.3, 0.4, 0.5], "over_white has 3 channels: must have 2 like over_black"),
])
def test_colours_that_no_layer_shows(dark, bright, sentence):
    with pytest.raises(StackError) as caught:
        match(dark, bright)
    assert str(caught.value) == sentence
    with pytest.raises(lamina.ArgumentError, match="white"):
        match(0.1, 0.2, white=0.0)


@pytest.mark.parametrize(("albedo", "tau", "over", "times", "phase"), [
    (0.9, 0.5, 0.1, 2.0, None), (0.6, 0.3, 0.8, 2.0, HenyeyGreenstein(0.6)), (0.999, 4.0, 0.05, 3.0, Rayleigh()),
    ((0.9, 0.5, 0.2), (3.0, 0.4, 0.8), (0.1, 0.7, 0.5), 1.5, HenyeyGreenstein((0.1, 0.5, -0.3))),
])
def test_a_coat_is_found_again_from_one_and_more(albedo, tau, over, times, phase):
    """From colours of the solver of all directions."""
    more = {} if phase is None else {"phase": phase}
    once = seen(Medium(albedo, tau, **more), over)
    twice = seen(Medium(albedo, tuple(times * np.array(tau)) if np.ndim(tau) else times * tau, **more), over)
    found = match_coats(once, twice, over, phase, times)
    assert np.array(found.albedo) == pytest.approx(np.array(albedo), abs=1e-3)
    assert np.array(found.tau) == pytest.approx(np.array(tau), rel=1e-2)
    assert seen(Medium(found.albedo, found.tau, **more), over) == pytest.approx(once, abs=1e-5)


def test_equal_coats_are_infinitely_thick():
    assert match_coats(0.4, 0.4, 0.1).tau == math.inf


@pytest.mark.parametrize(("once", "twice", "over", "sentence"), [
    (0.3, 0.2, 0.1, "twice[0] = 0.2: must lie beyond once, 0.3, as seen from over, 0.1"),
    (0.3, 0.4, 0.3, "twice[0] = 0.4: must lie beyond once, 0.3, as seen from over, 0.3"),
    (0.3, 0.9, 0.1, "twice[0] = 0.9: a coat that shows 0.3 over 0.1 shows at most 0.4"),
    ([0.3, 0.3], [0.2, 0.05], 0.5, "twice[1] = 0.05: a coat that shows 0.3 over 0.5 shows at least 0.18"),
])
def test_coats_that_no_layer_shows(once, twice, over, sentence):
    with pytest.raises(StackError) as caught:
        match_coats(once, twice, over)
    assert str(caught.value).startswith(sentence)
    with pytest.raises(lamina.ArgumentError, match="times"):
        match_coats(0.2, 0.3, 0.1, times=1.0)
