# SPDX-License-Identifier: GPL-3.0-or-later
"""Pigments and metals by name, and colours in stacks with wavelengths."""

import itertools

import numpy as np
import pytest
from scipy.optimize import minimize

import lamina
from lamina import Conductor, HenyeyGreenstein, Interface, Knot, Lambert, Medium, Spectrum, Stack, StackError, pigments
from lamina.colours import rec709
from lamina.common.observer import rec709_of
from lamina.kinds.media import ALBEDO, SIGMA_A
from lamina.kinds.phases import G
from lamina.material.smooth_spectra import smoothest

BLOOD = Medium(pigment="oxyhemoglobin", amount=0.02, sigma_s=2.0, thickness=0.5, phase=HenyeyGreenstein(0.8))
WAVELENGTHS = lamina.WAVELENGTHS
PEER = {"D65": (1.012572, 0.234121, -0.048394), "A": (1.015307, 0.315796, -0.066596),
        "E": (1.018703, 0.253709, -0.050687), "LED": (1.060374, 0.301477, -0.060309)}


def test_pigments_have_their_published_absorption():
    """Per cm: whole blood at 540 nm by Prahl's table, 53,236 / cm / M; melanosomes by Jacques; chlorophyll in a green
    leaf of 40 ug/cm2 in .2 mm, which absorbs most red light near 675 nm."""
    assert 10.0 * pigments.absorption("oxyhemoglobin").at(540.0) == pytest.approx(
        np.log(10.0) * 53236.0 * 150.0 / 64500.0, rel=1e-4)
    assert 10.0 * pigments.absorption("melanin").at(500.0) == pytest.approx(0.1 * 1.70e12 * 500.0**-3.48, rel=1e-3)
    green = pigments.absorption("chlorophyll")
    assert max(green.wavelengths, key=lambda nm: green.at(nm) if nm > 550 else 0.0) == pytest.approx(675.0, abs=5.0)
    assert pigments.absorption("water").at(600.0) == pytest.approx(2.22e-4, rel=0.02)  # Pope and Fry 1997
    for name in pigments.names():
        assert pigments.source(name) and pigments.amount_of(name)
        spectrum = pigments.absorption(name, 3.0)
        assert min(spectrum.values) >= 0.0 and spectrum.at(500.0) == 3.0 * pigments.absorption(name).at(500.0)


def test_spectra_add_up():
    skin = pigments.absorption("melanin", 0.3) + 0.05 * pigments.absorption("oxyhemoglobin")
    for nm in (400.0, 541.0, 700.0):
        assert skin.at(nm) == pytest.approx(
            0.3 * pigments.absorption("melanin").at(nm) + 0.05 * pigments.absorption("oxyhemoglobin").at(nm))
    assert (Spectrum([400, 500], [1, 3]) + Spectrum([450], [1])).at(450.0) == 3.0


@pytest.mark.parametrize("amount", [-1.0, np.nan, "x", None, [1.0, 2.0], 1j, True, 10**400])
def test_amounts_that_cannot_be(amount):
    with pytest.raises(lamina.ArgumentError, match="^amount = "):
        pigments.absorption("melanin", amount)


def test_a_pigment_is_the_spectrum_of_its_amount():
    sigma_a = pigments.absorption("oxyhemoglobin", 0.02)
    same = Medium(sigma_s=2.0, sigma_a=sigma_a, thickness=0.5, phase=HenyeyGreenstein(0.8))
    named, explicit = (Stack([Interface(1.4), medium], Lambert(0.5)) for medium in (BLOOD, same))
    assert named.wavelengths == WAVELENGTHS and named.hash == explicit.hash
    with pytest.raises(StackError, match="pigment: must be in a Stack, which has wavelengths"):
        lamina.colours.shown(BLOOD)


def test_json_holds_names_and_colours():
    """And no wavelengths if names imply the usual ones."""
    stack = Stack([BLOOD, Medium(color=[0.8, 0.5, 0.3], tau=2.0)], Conductor(metal="gold", alpha=0.2))
    data = stack.to_json()
    assert "wavelengths" not in data and data["base"] == {"kind": "conductor", "metal": "gold", "alpha": 0.2}
    assert data["layers"][0]["pigment"] == "oxyhemoglobin" and data["layers"][1]["color"] == [0.8, 0.5, 0.3]
    assert Stack.from_json(data).hash == stack.hash and Stack.from_json(data).to_json() == data
    few = Stack([BLOOD], Lambert([0.1, 0.2, 0.3]), wavelengths=[450.0, 550.0])
    assert few.to_json()["wavelengths"] == [450.0, 550.0] and Stack.from_json(few.to_json()).hash == few.hash
    thinner = few.with_sizes([few.layers[0]])
    assert Stack.from_json(thinner.to_json()).hash == few.hash


@pytest.mark.parametrize(("changes", "sentence"), [
    ({"pigment": "paprika"}, "layers[0].pigment = 'paprika': must be \"oxyhemoglobin\" or "),
    ({"amount": None}, "layers[0].amount is missing: must have either"),
    ({"amount": -1.0}, "layers[0].amount = -1: must lie in [0, 1e09]"),
    ({"amount": [1.0, 2.0, 3.0]}, "layers[0].amount = [1.0, 2.0, 3.0]: must be one number for all channels"),
    ({"sigma_a": 1.0}, "layers[0] has two forms"),
    ({"profile": [Knot(0.0, albedo=0.5), Knot(1.0, albedo=0.6)]}, "layers[0]"),
])
def test_bad_pigments(changes, sentence):
    given = {"pigment": "melanin", "amount": 0.1, "sigma_s": 1.0, "thickness": 1.0, **changes}
    with pytest.raises(StackError) as caught:
        Stack([Medium(**given)], Lambert(0.5))
    assert str(caught.value).startswith(sentence)
    with pytest.raises(StackError, match="metal = 'wood'"):
        Stack([], Conductor(metal="wood"))


def test_every_color_has_a_spectrum():
    """Shares stay in [0, 1], and coefficients above 0."""
    rows = rec709_of(WAVELENGTHS)
    for rgb in itertools.product((0.0, 0.05, 0.5, 1.0), repeat=3):
        values = np.array(smoothest(rgb, WAVELENGTHS, ALBEDO))
        assert rows @ values == pytest.approx(np.array(rgb), abs=5e-5)
        assert values.min() >= 0.0 and values.max() <= 1.0
    for rgb in itertools.product((0.01, 1.0, 7.0), repeat=3):
        assert rows @ smoothest(rgb, WAVELENGTHS, SIGMA_A) == pytest.approx(np.array(rgb), abs=1e-8)
    assert rows @ smoothest((-0.2, 0.1, 0.6), WAVELENGTHS, G) == pytest.approx(np.array([-0.2, 0.1, 0.6]), abs=1e-8)
    assert smoothest((0.3, 0.3, 0.3), WAVELENGTHS, ALBEDO) == (0.3,) * len(WAVELENGTHS)


@pytest.mark.parametrize("rgb", [(0.8, 0.2, 0.1), (0.1, 0.3, 0.8), (0.4, 0.5, 0.05)])
def test_the_spectrum_of_a_color_is_the_smoothest(rgb):
    """Against the minimum that scipy's SLSQP finds."""
    rows = rec709_of(WAVELENGTHS)
    found = smoothest(rgb, WAVELENGTHS, ALBEDO)
    step = np.diff(np.eye(16), axis=0)
    color = {"type": "eq", "fun": lambda z: rows @ (0.5 + 0.5 * np.tanh(z)) - rgb,
             "jac": lambda z: rows * (0.5 / np.cosh(z) ** 2)}
    peer = minimize(lambda z: np.sum((step @ z) ** 2), np.zeros(16), method="SLSQP", options={"maxiter": 500},
                    jac=lambda z: 2.0 * step.T @ step @ z, constraints=color, tol=1e-12)
    assert peer.success
    assert np.array(found) == pytest.approx(0.5 + 0.5 * np.tanh(peer.x), abs=2e-4)


def test_a_color_below_a_pigment_is_the_color_where_there_is_none():
    rgb = (0.7, 0.4, 0.2)
    clean = Stack([Medium(pigment="melanin", amount=0.0, sigma_s=0.0, thickness=1.0)], Lambert(rgb))
    assert rec709(lamina.solve(clean).reflectance(0.6), WAVELENGTHS) == pytest.approx(np.array(rgb), abs=1e-6)


def test_a_table_of_blood_has_the_color_of_all_wavelengths():
    every = tuple(np.arange(380.0, 785.0, 5.0))
    usual, fine = (Stack([Interface(1.4), BLOOD], Lambert((0.7, 0.5, 0.4)), wavelengths=w) for w in (None, every))
    found = lamina.bake(usual, "preview").reflectance(0.7)
    assert found == pytest.approx(rec709(lamina.solve(fine, "preview").reflectance(0.7), every), abs=6e-3)


def test_the_illuminant_changes_dyes_and_leaves_white_white():
    """Light of A makes blood brighter than D65 does, relative to white. A spectrum of one's own: equal energy is E."""
    colour = {}
    for light in ("D65", "A", "E", "LED", Spectrum([400, 700], [2.0, 2.0])):
        clear = Medium(pigment="melanin", amount=0.0, sigma_s=0.0, thickness=1.0)
        white = Stack([clear], Lambert(0.7), illuminant=light)
        assert white.seen(lamina.solve(white).reflectance(0.5)) == pytest.approx(np.full(3, 0.7), abs=1e-9)
        stack = Stack([BLOOD], Lambert(0.7), illuminant=light)
        colour[light] = lamina.bake(stack, "preview").reflectance(0.6)
        assert colour[light] == pytest.approx(stack.seen(lamina.solve(stack, "preview").reflectance(0.6)), rel=2e-3)
        again = Stack.from_json(stack.to_json())
        assert again.hash == stack.hash and again.illuminant == stack.illuminant
    assert len({stack.hash for stack in (Stack([BLOOD], illuminant=light) for light in ("D65", "A", "E", "LED"))}) == 4
    assert colour["A"][0] > colour["D65"][0] + 0.01
    assert colour["E"] == pytest.approx(colour[Spectrum([400.0, 700.0], [2.0, 2.0])], abs=1e-12)


def test_colours_under_an_illuminant_are_those_of_a_peer():
    """Of colour-science 0.4.7: sd_to_XYZ under A and LED-B3, chromatic adaptation by Bradford's matrix, XYZ_to_RGB."""
    every = tuple(np.arange(380.0, 785.0, 5.0))
    bell = np.exp(-(((np.array(every) - 600.0) / 40.0) ** 2))
    for light, wanted in PEER.items():
        assert rec709(bell, every, illuminant=light) == pytest.approx(np.array(wanted), abs=2e-5)


@pytest.mark.parametrize(("light", "sentence"), [
    ("sun", "illuminant = 'sun': must be \"D65\" or \"A\" or \"E\" or \"LED\""),
    (Spectrum([400, 700], [0, 0]), "illuminant.values: must not all be 0"),
    (Spectrum([150, 160, 170], [0, 1, 0]), "illuminant.values: must not all be 0 from 380 to 780 nm"),
    (Spectrum([400, 700], [-1, 0]), "illuminant.values"),
])
def test_bad_illuminants(light, sentence):
    with pytest.raises(StackError) as caught:
        Stack([BLOOD], illuminant=light)
    assert str(caught.value).startswith(sentence)
    with pytest.raises(StackError, match="illuminant = 'A': must be left out of a stack without wavelengths"):
        Stack([], Lambert(0.5), illuminant="A")


def test_lamps_with_narrow_lines():
    """Lines between the wavelengths of the observer's table: between these the observer is linear, so a line counts as
    its two neighbours, each by its nearness."""
    bell, every = np.exp(-(((np.arange(400, 701, 10) - 600) / 50) ** 2)), tuple(range(400, 701, 10))
    lines, width = (437.0, 546.0, 612.0), 0.5
    lamp = Spectrum([line + side for line in lines for side in (-width, 0.0, width)], [0.0, 5.0 / width, 0.0] * 3)
    table = np.arange(380.0, 781.0, 5.0)
    same = Spectrum(table.tolist(), sum(np.maximum(1.0 - abs(table - line) / 5.0, 0.0) for line in lines).tolist())
    np.testing.assert_allclose(rec709(bell, every, illuminant=lamp), rec709(bell, every, illuminant=same), rtol=1e-9)
    baked = lamina.bake(Stack([BLOOD], Lambert(0.7), illuminant=Spectrum([531, 532, 533], [0, 1, 0])), "preview")
    assert np.ptp(baked.reflectance(0.9)) < 0.05 * baked.reflectance(0.9).mean()


@pytest.mark.parametrize(("values", "wavelengths", "sentence"), [
    ([0.5], (500, 600), r"values has the shape \(1,\): must have 2 values along axis -1"),
    (0.5, (500,), "values has the shape"), ([0.5, 0.5], (500, 500), "wavelengths: must differ from one another")])
def test_bad_arguments_of_rec709(values, wavelengths, sentence):
    with pytest.raises((lamina.ArgumentError, StackError), match=sentence):
        rec709(values, wavelengths)
    with pytest.raises(StackError, match="illuminant = 'F2'"):
        rec709([0.5, 0.5], np.array([500.0, 600.0]), illuminant="F2")


def test_the_two_colours_of_a_metal_by_its_spectrum_are_not_asked_of_it():
    with pytest.raises(StackError, match="conductor.metal: must be in a Stack, which has wavelengths"):
        lamina.metals.colours_of(Conductor(metal="gold"))
