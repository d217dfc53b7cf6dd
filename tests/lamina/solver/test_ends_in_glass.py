# SPDX-License-Identifier: GPL-3.0-or-later
"""A sheet that does not end in air has values for light from above and refuses directions in the medium below."""

import pytest

import lamina
from lamina import Interface, Lambert, Medium, Stack, StackError

GLASS = Stack([Interface(1.5)])
MURKY = Stack([Interface([1.5, 1.0, 1.0]), Medium(albedo=0.5, tau=1.0)])
SENTENCE = ("layers end at index 1.5: a sheet that is baked, or whose directions below are asked for, "
            "must end with an Interface of ior 1")


@pytest.mark.parametrize("ask", [
    lambda s: s.reflectance(0.5, "bottom"),
    lambda s: s.reflectance("diffuse", "bottom"),
    lambda s: s.transmittance(0.5, "bottom"),
    lambda s: s.absorption(0.5, "bottom"),
    lambda s: s.brdf(0.5, 0.5, 0.0, "bottom"),
    lambda s: s.btdf(0.5, 0.5, 0.0),
    lambda s: s.btdf(0.5, 0.5, 0.0, "bottom"),
    lambda s: s.grid("transmit", 0.5, 0.5, 0.0),
    lambda s: s.grid("reflect", 0.5, 0.5, 0.0, "bottom"),
    lamina.export.tabulate,
])
def test_directions_below_are_refused(ask):
    with pytest.raises(StackError) as caught:
        ask(lamina.solve(GLASS))
    assert str(caught.value) == SENTENCE


@pytest.mark.parametrize("ask", [
    {"mu_o": 0.5, "path": "transmit"},
    {"mu_o": 0.5, "side": "bottom"},
    {"mu_o": None, "side": "bottom"},
    {"mu_o": None, "side": "bottom", "path": "transmit"},
])
@pytest.mark.parametrize("method", ["transfer", "adding"])
def test_walks_refuse_them_too(ask, method):
    with pytest.raises(StackError) as caught:
        lamina.estimate(GLASS, mu_i=0.5, method=method, samples=4096, **ask)
    assert str(caught.value) == SENTENCE


def test_one_channel_in_glass_is_enough():
    with pytest.raises(StackError, match=r"layers end at index \[1.5, 1.0, 1.0\]: a sheet"):
        lamina.solve(MURKY).reflectance(0.5, "bottom")


def test_light_from_above_is_answered():
    """At normal incidence Fresnel's reflectance is .04; the rest of the light is in the glass."""
    solved = lamina.solve(GLASS)
    assert solved.reflectance(1.0)[0] == pytest.approx(0.04, rel=1e-9)
    for mu0 in (0.05, 0.5, "diffuse"):
        assert solved.absorption(mu0)[0] == pytest.approx(0.0, abs=1e-9)


def test_what_is_answered_agrees_with_a_closed_sheet():
    """The medium below may be black glass as well: nothing comes back from either."""
    layers = [Interface(1.5), Medium(albedo=0.8, tau=0.7)]
    opened, closed = lamina.solve(Stack(layers)), lamina.solve(Stack(layers, Lambert(0.0)))
    assert opened.brdf(0.3, 0.8, 1.0) == pytest.approx(closed.brdf(0.3, 0.8, 1.0), rel=1e-9)
    assert opened.reflectance("diffuse") == pytest.approx(closed.reflectance("diffuse"), rel=1e-9)
