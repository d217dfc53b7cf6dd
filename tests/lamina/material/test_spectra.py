# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities by wavelength, and their colours."""

import numpy as np
import pytest

import lamina
from lamina import (
    Conductor,
    HenyeyGreenstein,
    Interface,
    Lambert,
    Medium,
    PrincipledBase,
    Spectrum,
    Stack,
    StackError,
    metals,
)
from lamina.colours import rec709
from lamina.common.observer import rec709_of, rec709_under

EVERY, ROWS = rec709_under()
BELL = np.exp(-(((EVERY - 520.0) / 50.0) ** 2))
DYES = {"red": 3.0 * BELL, "blue": 3.0 * np.exp(-(((EVERY - 600.0) / 60.0) ** 2)),
        "yellow": 3.0 * np.exp(-(((EVERY - 430.0) / 40.0) ** 2))}
# Largest error of a colour by the default wavelengths: some dE2000 = .6.
COLOUR = 8e-3


def dyed(absorption, amount, wavelengths=None):
    """A dye in white paint over white."""
    sigma_a = Spectrum(EVERY, 0.05 + absorption)
    return Stack([Interface(1.5), Medium(sigma_s=1.0, sigma_a=sigma_a, thickness=amount)], Lambert(0.8),
                 wavelengths=wavelengths)


def test_each_quantity_may_be_a_spectrum():
    """A stack of spectra is that of their values at the wavelengths."""
    ramp, wavelengths = Spectrum([400.0, 700.0], [0.1, 0.4]), [400.0, 500.0, 700.0]
    values = (0.1, 0.2, 0.4)
    one = Stack([Interface(Spectrum([400.0, 700.0], [1.4, 1.7])), Medium(ramp, ramp, phase=HenyeyGreenstein(ramp))],
                Conductor(ramp, ramp), wavelengths=wavelengths)
    other = Stack([Interface((1.4, 1.5, 1.7)), Medium(values, values, phase=HenyeyGreenstein(values))],
                  Conductor(values, values), wavelengths=wavelengths)
    assert one.wavelengths == tuple(wavelengths)
    assert one.layers[1].albedo == pytest.approx(values) and one.base.k == pytest.approx(values)
    assert lamina.solve(one).reflectance(0.7) == pytest.approx(lamina.solve(other).reflectance(0.7), rel=1e-12)


def test_json_keeps_the_values():
    stack = dyed(DYES["red"], 1.0)
    assert stack.wavelengths == lamina.WAVELENGTHS and stack.channels == len(lamina.WAVELENGTHS)
    again = Stack.from_json(stack.to_json())
    assert again.hash == stack.hash and again.wavelengths == stack.wavelengths
    given = {"kind": "medium", "albedo": {"wavelengths": [400, 700], "values": [0.2, 0.8]}, "tau": 1.0}
    read = Stack.from_json({"schema": 1, "layers": [given], "base": {"kind": "black"}, "wavelengths": [550]})
    assert read.layers[0].albedo == pytest.approx((0.5,))


def test_white_is_white_and_all_wavelengths_are_the_observer():
    assert rec709_of(tuple(EVERY)) == pytest.approx(ROWS, abs=1e-12)
    for wavelengths in (lamina.WAVELENGTHS, (550.0,), (700.0, 400.0, 500.0)):
        assert rec709(np.ones(len(wavelengths)), wavelengths) == pytest.approx(np.ones(3), abs=1e-12)
    mixed, order = rec709_of((400.0, 500.0, 700.0)), [2, 0, 1]
    assert rec709_of((700.0, 400.0, 500.0)) == pytest.approx(mixed[:, order], abs=1e-12)


@pytest.mark.parametrize("name", metals.names())
def test_metals_by_index_have_their_published_colours(name):
    """Those of the table, which Mitsuba's own spectral rendering confirms: see test_metal_colours. The red of gold, 1
    facing and thus 1 at all angles in the table, is .9994 at grazing."""
    stack = Stack([], Conductor(metal=name), wavelengths=EVERY)
    for mu, colour in zip((1.0, metals.GRAZING), metals.colours_of(metals.conductor(name)), strict=True):
        shown = rec709(lamina.solve(stack).reflectance(mu), tuple(EVERY))
        assert np.clip(shown, 0.0, 1.0) == pytest.approx(np.array(colour), abs=1e-3 if name == "gold" else 1e-4)


@pytest.mark.parametrize("amount", [0.25, 1.0, 3.0])
@pytest.mark.parametrize("dye", DYES)
def test_the_default_wavelengths_suffice_for_dyes(dye, amount):
    exact = rec709(lamina.solve(dyed(DYES[dye], amount, EVERY)).reflectance(1.0), tuple(EVERY))
    mine = rec709(lamina.solve(dyed(DYES[dye], amount)).reflectance(1.0), lamina.WAVELENGTHS)
    assert mine == pytest.approx(exact, abs=COLOUR)


def test_the_table_is_the_colour_of_the_solve():
    stack = dyed(0.5 * DYES["red"], 0.5)
    lut, solved = lamina.bake(stack, quality="preview"), lamina.solve(stack, "preview")
    mu = np.array([0.2, 0.6, 1.0])
    wanted = rec709(solved.reflectance(mu), stack.wavelengths)
    assert (wanted > 0.05).all()  # inside the gamut
    assert lut.reflectance(mu) == pytest.approx(wanted, rel=2e-3)
    seen = rec709(solved.brdf(0.8, 0.5, 2.0), stack.wavelengths)
    assert lut.evaluate(0.8, 0.5, 2.0) == pytest.approx(seen, rel=0.05)
    assert lut.compare(stack).mean == pytest.approx(lut.report["fit_error"], rel=1e-3)


def test_what_leaves_the_gamut_fades_to_gray():
    """Its luminance stays, and its least channel has 1 % of it. The report tells the share of gray."""
    stack = dyed(np.where(np.abs(EVERY - 520.0) < 15.0, 0.0, 50.0), 1.0)
    paint = rec709(lamina.solve(stack, "preview").reflectance(1.0, parts=True)[0], stack.wavelengths)
    baked = lamina.bake(stack, quality="preview")
    shown = baked.reflectance(1.0, parts=True)[0]
    luminance = paint @ (0.2126, 0.7152, 0.0722)
    share = (0.01 * luminance - paint.min()) / (luminance - paint.min())
    assert paint.min() < -1e-3
    assert shown == pytest.approx(paint + share * (luminance - paint), rel=1e-4)
    assert shown.min() == pytest.approx(0.01 * luminance, rel=1e-4)
    assert baked.report["faded"] == pytest.approx(share, abs=0.05) and baked.report["fit_error"] < 0.02
    assert "faded" not in lamina.bake(Stack([], Lambert(0.5)), "preview").report


def test_labelled_values_have_wavelengths():
    pytest.importorskip("xarray")
    found = lamina.solve(dyed(DYES["blue"], 1.0)).to_xarray()
    assert tuple(found.channel.values) == lamina.WAVELENGTHS and found.channel.attrs["units"] == "nm"


RAMP = Spectrum([400.0, 700.0], [0.1, 0.4])
PLATE = Medium(pigment="water", amount=1.0, sigma_s=1.0, thickness=1.0)
CLEAR = Stack([Medium(sigma_s=2.0, sigma_a=Spectrum([400.0, 700.0], [0.1, 0.0]), thickness=np.inf)],
              wavelengths=[400.0, 700.0])


@pytest.mark.parametrize(("made", "words"), [
    (lambda: Stack([Medium(Spectrum([700, 400], [0.1, 0.2]), 1.0)]), "albedo.wavelengths: must be ascending"),
    (lambda: Stack([Medium(Spectrum([400], [1.5]), 1.0)]), "layers\\[0\\].albedo\\[0\\] = 1.5"),
    (lambda: Stack([Medium(Spectrum(5, 7), 1.0)]), "albedo.wavelengths = 5: must be a list"),
    (lambda: Stack([Medium(RAMP, (1.0, 2.0))]), "channels"),
    (lambda: Stack([Medium(RAMP, 1.0)], wavelengths=[500, 500]), "wavelengths: must differ"),
    (lambda: lamina.bake(Stack([Medium(RAMP, 1.0)], Lambert(RAMP, textured=True))), "base.reflectance: must be one"),
    (lambda: lamina.bake(Stack([Medium(RAMP, 1.0)], PrincipledBase(RAMP))), "base.color: must be one number"),
    (lambda: lamina.portal_tables(Stack([PLATE, PLATE]), "preview"), "must be one homogeneous medium, below at most"),
    (lambda: lamina.interior_of_stack(Stack([Medium(pigment="water", amount=1.0, sigma_s=0.0, thickness=1.0)])),
     "sigma_s = 0: must be above 0"),
    (lambda: lamina.interior_of_stack(Stack([PLATE, PLATE])), "must be one homogeneous medium, below at most"),
    (lambda: lamina.subsurface_nodes(CLEAR, quality="preview"), "700 nm: light that nothing absorbs"),
])
def test_errors_are_sentences(made, words):
    with pytest.raises(StackError, match=words):
        made()


@pytest.mark.parametrize(("made", "words"), [
    (lambda: RAMP.at([500.0]), "wavelength = \\[500.0\\]: must be one number, in nm"),
    (lambda: RAMP.at(np.nan), "wavelength = nan: must be one number"),
    (lambda: Spectrum([400, 500, 600], [1, 2]).at(550.0), "must be ascending wavelengths, and a number for each"),
    (lambda: Spectrum([600, 400], [1, 2]).at(550.0), "must be ascending wavelengths"),
    (lambda: Spectrum(5, 7).at(550.0), "wavelengths = 5, values = 7: must be ascending"),
    (lambda: Spectrum([400, 500], ["1", "2"]) + RAMP, "must be ascending wavelengths, and a number for each"),
    (lambda: RAMP * np.array([1.0, 2.0]), "factor = \\[1.0, 2.0\\]: a spectrum can be multiplied by one number only"),
    (lambda: np.array([1.0, 2.0]) * RAMP, "factor = \\[1.0, 2.0\\]"),
    (lambda: RAMP * "2", "factor = '2'"),
    (lambda: RAMP + 1.0, "summand = 1.0: only a Spectrum can be added"),
])
def test_sums_and_values_of_what_is_no_spectrum(made, words):
    with pytest.raises(StackError, match=words):
        made()


@pytest.mark.parametrize(("arguments", "words"), [
    ((["a", "b"], [500, 600]), "values = \\['a', 'b'\\]: must be an array of numbers"),
    (([0.1, 0.2], [500, 600], 1), "axis = 1: must be a whole number from -1 to 0"),
    (([0.1, 0.2], [500, 600], None), "axis = None"),
    ((0.1, [500, 600]), "values has the shape \\(\\): must have 2 values"),
    (([0.1, 0.2], [500, 600], -1, []), "illuminant = \\[\\]: must be"),
])
def test_colours_of_what_is_no_spectrum(arguments, words):
    with pytest.raises(ValueError, match=words):
        rec709(*arguments)


def test_a_factor_may_be_any_one_number():
    for double in (2.0 * RAMP, np.float64(2.0) * RAMP, RAMP * np.array(2.0)):
        assert double.values == (0.2, 0.8)
    assert (Spectrum([400, 500], [1.0 + 2.0j, 3.0]) * 2).at(400.0) == 2.0 + 4.0j


def test_files(tmp_path):
    path = tmp_path / "dye.csv"
    path.write_text("# a dye\nnm,absorption\n400,1.5\n500, 2\n", encoding="utf-8")
    assert Spectrum.load(path) == Spectrum((400.0, 500.0), (1.5, 2.0))
    path.write_text("400 1.5\n500\t2\n", encoding="utf-8")
    assert Spectrum.load(path).at(450.0) == 1.75
    for text, words in (("400,1\n500,x\n", "line 2"), ("", "no wavelengths"), ("500,1\n400,1\n", "ascending")):
        path.write_text(text, encoding="utf-8")
        with pytest.raises(StackError, match=words):
            Spectrum.load(path)


def test_files_of_spreadsheets(tmp_path):
    """Their texts may begin with a byte order mark, after which the first line was taken for names of columns."""
    path = tmp_path / "dye.csv"
    path.write_text("400,1\n500,2\n", encoding="utf-8-sig")
    assert Spectrum.load(path) == Spectrum((400.0, 500.0), (1.0, 2.0))
    path.write_bytes("400,1\n500,2\n".encode("utf-16"))
    with pytest.raises(StackError, match=r"dye\.csv: must be a text in UTF-8$"):
        Spectrum.load(path)
