# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers of flakes as parts of a stack: JSON, hashes, channels, checks of values."""

import json

import pytest

import lamina
from lamina import Film, Flakes, Interface, Lambert, Medium, Spectrum, Stack, StackError
from lamina.common.observer import rec709_under
from lamina.kinds.fields import channel
from lamina.kinds.flakes import MICA
from lamina.material.thickness import with_thickness
from lamina.solver.core_stack import core_stack

FLAKES = [Flakes(1.0, 0.2, reflectance=0.9),
          Flakes([0.5, 1.0, 2.0], 0.3, reflectance=[0.9, 0.8, 0.7], binder=0.2, name="Pearl", varying=True),
          lamina.metals.flakes("gold", 0.5, 0.15),
          Flakes(0.5, 0.15, eta=[0.2, 0.4, 1.3], k=[3.2, 2.4, 1.9]),
          Flakes(0.5, 0.15, metal="copper"),
          Flakes(0.5, 0.15, reflectance=[0.3, 0.2, 0.1], pearl=True)]


@pytest.mark.parametrize("flakes", FLAKES)
def test_json_and_back(flakes):
    stack = Stack([Interface(1.5), flakes], Lambert(0.5))
    again = Stack.from_json(stack.to_json())
    assert again == stack
    assert again.hash == stack.hash
    assert Stack.from_json(json.loads(stack.canonical())).hash == stack.hash  # tables hold the canonical form


def test_hashes():
    """Of what is shown: not of names, nor of the form in which a colour is repeated."""
    def of(**more):
        return Stack([Flakes(**{"tau": 1.0, "alpha": 0.2, "reflectance": 0.9, **more})], Lambert([0.5, 0.5, 0.5])).hash

    assert of(name="a") == of(reflectance=[0.9] * 3)
    others = of(pearl=True), of(tau=2.0), of(alpha=0.3), of(reflectance=0.8), of(binder=0.1), of(varying=True)
    assert len({of(), *others}) == 7


def test_pearl_flakes_pass_what_they_do_not_reflect():
    """A flake that reflects R of the light is as good as R white flakes, in the values that the solver gets."""
    rgb = (0.5, 0.25, 0.0)
    pearl = Stack([Flakes(2.0, 0.2, reflectance=rgb, binder=0.3, pearl=True)], Lambert(0.5))
    white = Stack([Flakes([2.0 * r for r in rgb], 0.2, reflectance=1.0, binder=0.3)], Lambert(0.5))
    assert [core_stack(pearl, c)[0] for c in range(3)] == [core_stack(white, c)[0] for c in range(3)]
    sheet = lamina.solve(Stack([Flakes(2.0, 0.2, reflectance=rgb, pearl=True)]))
    assert sheet.reflectance(0.7) + sheet.transmittance(0.7) == pytest.approx([1.0] * 3, abs=1e-3)


def test_the_thickness_of_pearl_flakes():
    pearl = Stack([Flakes(2.0, 0.2, reflectance=[0.5, 0.25, 0.125], binder=0.3, pearl=True, varying=True)])
    taus = tuple(0.5 * pearl.optics(0, c)[1] for c in range(3))
    half = with_thickness(pearl, 0, taus)
    for c in range(3):
        assert channel(half.layers[0].tau, c) == pytest.approx(1.0)
        assert channel(half.layers[0].binder, c) == pytest.approx(0.15)
        assert half.optics(0, c) == pytest.approx((pearl.optics(0, c)[0], taus[c]))


def test_flakes_and_binder_share_the_extinction():
    """In the optics that the solver gets."""
    stack = Stack([Flakes(1.0, 0.2, reflectance=0.5, binder=[0.0, 1.0, 3.0])])
    assert [stack.optics(0, c) for c in range(3)] == [(0.5, 1.0), (0.25, 2.0), (0.125, 4.0)]


@pytest.mark.parametrize(("values", "words"), [
    ({"alpha": 0.05, "reflectance": 0.5}, r"layers\[0\].alpha = 0.05: must lie in \[0.1, 1\]"),
    ({"alpha": [0.2, 0.3], "reflectance": 0.5}, r"layers\[0\].alpha .* must be one number for all channels"),
    ({"reflectance": 1.5}, r"layers\[0\].reflectance = 1.5: must lie in \[0, 1\]"),
    ({}, r"layers\[0\] has no coefficients: must have either reflectance or facing, grazing or metal or eta, k"),
    ({"reflectance": 0.5, "metal": "gold"}, r"layers\[0\] has two forms"),
    ({"metal": "unobtainium"}, r"layers\[0\].metal = 'unobtainium': must be \"gold\" or \"aluminium\""),
    ({"eta": 1.0}, r"layers\[0\].k is missing"),
    ({"reflectance": 0.5, "facing": 0.5, "grazing": 0.6}, r"layers\[0\] has two forms"),
    ({"facing": 0.9}, r"layers\[0\].grazing is missing"),
    ({"facing": 0.9, "grazing": 0.1}, r"layers\[0\].grazing = 0.1: a metal of facing colour 0.9 shows between"),
    ({"reflectance": 0.5, "tau": -1.0}, r"layers\[0\].tau = -1: must lie in \[0, 1000\]"),
    ({"reflectance": 0.5, "binder": -1.0}, r"layers\[0\].binder = -1: must lie in \[0, 1000\]"),
    ({"reflectance": 0.5, "varying": 1}, r"layers\[0\].varying = 1: must be false or true"),
    ({"reflectance": 0.5, "tau": "inf"}, r"layers\[0\].tau = inf: must lie in \[0, 1000\]"),
    ({"reflectance": [0.5, 0.5], "tau": [1.0, 1.0, 1.0]}, "channels: must have"),
])
def test_bad_values(values, words):
    with pytest.raises(StackError, match=words):
        Stack([Flakes(**{"tau": 1.0, "alpha": 0.2, **values})])


def test_one_layer_varies():
    with pytest.raises(StackError, match=r"layers\[1\].varying = true: only one medium may vary"):
        Stack([Medium(0.5, 1.0, varying=True), Flakes(1.0, 0.2, reflectance=0.5, varying=True)])


def test_a_named_metal_is_its_index_at_each_wavelength():
    nm = [450.0, 550.0, 650.0]
    stack = Stack([Flakes(0.5, 0.15, metal="copper")], Lambert(0.1), wavelengths=nm)
    base = Stack([], lamina.Conductor(metal="copper"), wavelengths=nm)
    assert list(zip(*stack.flake_indices(0), strict=True)) == [base.indices(c) for c in range(3)]


def test_a_named_metal_looks_like_the_metal_by_its_colours():
    """Few flakes, which reflect light once: later reflections deepen spectra more than their colours. In air both
    colours are those of the published index, in a binder they are a good guess."""
    def of(flakes, above):
        stack = Stack([Interface(1.5)] * above + [flakes], Lambert(0.0))
        return stack.seen(lamina.solve(stack).reflectance("diffuse"))

    for above, most in ((0, 0.005), (1, 0.02)):
        spectral = of(Flakes(0.02, 0.2, metal="copper"), above)
        assert spectral == pytest.approx(of(lamina.metals.flakes("copper", 0.02, 0.2), above), rel=most)


def test_unknown_metal():
    with pytest.raises(lamina.UnknownName, match="metal"):
        lamina.metals.flakes("unobtainium", 1.0, 0.2)


def test_unknown_key():
    with pytest.raises(StackError, match=r"layers\[0\].spread: unknown key"):
        Stack.from_json({"schema": 1, "layers": [{"kind": "flakes", "tau": 1, "alpha": 0.2, "spread": 1}]})


FILMED = [Flakes(1.0, 0.2, film=Film(2.5, 120.0)),
          Flakes(1.0, 0.2, ior=1.46, film=[Film(1.46, 100.0), Film(2.3 + 0.4j, 20.0)], binder=0.1, varying=True),
          Flakes(1.0, 0.2, film=Film(Spectrum([400.0, 700.0], [2.8, 2.5]), 120.0)),
          Flakes(1.0, 0.2, metal="aluminium", film=Film(1.46, 200.0)),
          Flakes(1.0, 0.2, ior=1.7)]


@pytest.mark.parametrize("flakes", FILMED)
def test_films_in_json_and_back(flakes):
    stack = Stack([Interface(1.5), flakes], Lambert(0.5))
    again = Stack.from_json(json.loads(json.dumps(stack.to_json())))
    assert again == stack and again.hash == stack.hash
    assert Stack.from_json(json.loads(stack.canonical())).hash == stack.hash
    assert (stack.wavelengths is None) == (not stack.layers[1].film)
    assert eval(repr(stack.layers[1]), vars(lamina).copy()) == stack.layers[1]
    assert "<svg" in stack._repr_html_()


def test_one_film_or_a_list_on_mica():
    one, several = (Flakes(1.0, 0.2, film=film) for film in (Film(2.5, 120.0), [Film(2.5, 120.0)]))
    assert one == several and hash(one) == hash(several) and one.ior == MICA
    assert Flakes(1.0, 0.2, film=Film(2.5, 120.0), metal="gold").ior is None


def test_films_count_in_hashes():
    hashes = {Stack([Flakes(1.0, 0.2, **values)], wavelengths=[550.0]).hash for values in (
        {"ior": 1.5}, {"ior": 1.58}, {"film": Film(2.5, 100.0)}, {"film": Film(2.5, 110.0)}, {"film": Film(2.4, 100.0)},
        {"film": [Film(2.5, 100.0)] * 2}, {"film": Film(2.5, 100.0, k=0.1)}, {"film": Film(2.5, 100.0), "ior": 1.5})}
    assert len(hashes) == 8


@pytest.mark.parametrize(("values", "words"), [
    ({"film": 120.0}, r"layers\[0\].film = 120.0: must be a Film or a list of at most 16, outermost first"),
    ({"film": [Film(2.5, 1.0)] * 17}, r"layers\[0\].film has 17 entries: must be a Film or a list of at most 16"),
    ({"film": ["gold"]}, r"layers\[0\].film\[0\] = 'gold': must be a Film"),
    ({"film": Film(2.5, -1.0)}, r"layers\[0\].film\[0\].thickness = -1: must lie in \[0, 5000\] nm"),
    ({"film": Film([2.5, 2.6, 2.7], 100.0)}, r"layers\[0\].film\[0\].ior .* must be one number or a Spectrum"),
    ({"film": [{"ior": 2.5}]}, r"layers\[0\].film\[0\].thickness is missing"),
    ({"film": [{"ior": 2.5, "thickness": 1, "tau": 1}]}, r"layers\[0\].film\[0\].tau: unknown key"),
    ({"film": Film(2.5, 100.0), "reflectance": 0.5}, r"layers\[0\].film: must be left out beside a reflectance"),
    ({"ior": 5.0}, r"layers\[0\].ior = 5: must lie in \[1, 4\]"),
    ({"ior": 1.5, "metal": "gold"}, r"layers\[0\] has two forms"),
])
def test_bad_films(values, words):
    with pytest.raises(StackError, match=words):
        Stack([Flakes(1.0, 0.2, **values)])


@pytest.mark.parametrize("thickness", [80.0, 120.0, 160.0])
def test_the_default_wavelengths_suffice_for_interference(thickness):
    """At most dE2000 = .5 from 81 wavelengths, measured facing, at 46 and 66 degrees and in three directions."""
    def colours(nm):
        stack = Stack([Interface(1.5), Flakes(2.0, 0.2, film=Film(2.5, thickness))], Lambert(0.05), wavelengths=nm)
        return stack.seen(lamina.solve(stack).reflectance([1.0, 0.7, 0.4]))

    assert colours(None) == pytest.approx(colours(rec709_under()[0]), abs=2e-3)


def test_the_thickness_of_flakes_with_films():
    stack = Stack([Interface(1.5), Flakes(2.0, 0.2, film=Film(2.5, 120.0), binder=0.4)], Lambert(0.3),
                  wavelengths=[550.0])
    half = with_thickness(stack, 1, 1.2)
    assert (half.layers[1].tau, half.layers[1].binder) == pytest.approx((1.0, 0.2))
    derived = lamina.solve(stack).with_thickness(1, 1.2)
    assert derived.brdf(0.8, 0.5, 1.0) == pytest.approx(lamina.solve(half).brdf(0.8, 0.5, 1.0), rel=2e-4)
