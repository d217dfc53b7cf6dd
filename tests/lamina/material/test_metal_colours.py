# SPDX-License-Identifier: GPL-3.0-or-later
"""The colours of the metals: spectra of refractive indices, integrated with the CIE 1931 observer under D65."""

import math
import sys
from pathlib import Path

import mitsuba as mi
import numpy as np
import pytest

import lamina
from lamina import Stack, metals, presets
from lamina.common.observer import rec709_under

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "tools"))
import metal_colours

NAMES = metals.names()

# Akenine-Möller and others, Real-Time Rendering, 4th edition (2018), table 9.2: linear Rec. 709 at normal incidence,
# for the metals whose measurements there and here agree.
PUBLISHED = {
    "aluminium": (0.913, 0.922, 0.924),
    "brass": (0.910, 0.778, 0.423),
    "chromium": (0.549, 0.556, 0.554),
    "copper": (0.955, 0.638, 0.538),
    "gold": (1.000, 0.782, 0.344),
    "palladium": (0.733, 0.697, 0.652),
    "platinum": (0.673, 0.637, 0.585),
}


def facing(metal):
    """Reflectance of a smooth metal at normal incidence, by the solver."""
    return lamina.solve(Stack([], metal), quality="preview", threads=1).reflectance(1.0)


@pytest.mark.parametrize("name", PUBLISHED)
def test_published_colours(name):
    np.testing.assert_allclose(facing(metals.conductor(name)), PUBLISHED[name], atol=0.007)


def test_warm_metals_are_warm_and_zinc_is_not():
    """The blue of brass and bronze is under .6 of the green, and their green under .9 of the red: yellow and orange,
    not green. Zinc is bluish."""
    for name in ("gold", "copper", "brass", "commercial-bronze"):
        red, green, blue = facing(metals.conductor(name))
        assert green < 0.9 * red and blue < 0.9 * green
    assert np.all(np.diff(facing(metals.conductor("zinc"))) > 0.0)


def test_the_table_is_what_the_spectra_say():
    assert metal_colours.names() == NAMES
    assert metal_colours.OUTPUT.read_text(encoding="utf-8") == metal_colours.text()
    for name in NAMES:
        assert metals.source(name).startswith(metal_colours.source(name))


def test_a_perfect_mirror_is_white():
    _, response = rec709_under()
    np.testing.assert_allclose(response.sum(axis=1), 1.0, atol=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_mitsuba_sees_the_same_colours(name):
    """With its own observer, illuminant, matrix and Fresnel equations, every nanometre."""
    mi.set_variant("scalar_spectral")
    wavelengths = np.arange(380, 781)
    nm, n, k = metal_colours.read_table(metal_colours.SPECTRA / f"{name}.csv")
    indices = [mi.Complex2f(float(np.interp(w, nm, n)), float(np.interp(w, nm, k))) for w in wavelengths]
    light = np.array([np.array(mi.cie1931_xyz(float(w))) * float(mi.cie_d65(float(w))) for w in wavelengths])
    for mu, ours in zip((1.0, metals.GRAZING), metals.colours_of(metals.conductor(name)), strict=True):
        reflected = np.array([mi.fresnel_conductor(mu, index) for index in indices])
        xyz = light.T @ reflected / light[:, 1].sum()
        rgb = np.array(mi.xyz_to_srgb(mi.Color3f(*xyz)))
        np.testing.assert_allclose(np.clip(rgb, 0.0, 1.0), ours, atol=0.0015)


@pytest.mark.parametrize("symbol, name", [("Au", "gold"), ("Cu", "copper"), ("Al", "aluminium")])
def test_mitsubas_own_spectra_give_nearly_the_same_colours(symbol, name):
    """Mitsuba's indices of these metals come from other measurements."""
    files = Path(mi.__file__).parent / "data/ior"
    n, k = (np.loadtxt(files / f"{symbol}.{index}.spd").T for index in ("eta", "k"))
    wavelengths, response = rec709_under()
    indices = list(zip(np.interp(wavelengths, *n), np.interp(wavelengths, *k), strict=True))
    for mu, ours in zip((1.0, metals.GRAZING), metals.colours_of(metals.conductor(name)), strict=True):
        rgb = response @ np.array([metals.reflectance(mu, *index) for index in indices])
        np.testing.assert_allclose(np.clip(rgb, 0.0, 1.0), ours, atol=0.015)


@pytest.mark.parametrize("name", NAMES)
def test_two_colours_give_the_colour_at_every_angle(name):
    """The largest differences, .009 and .011, are those of the red of copper and bronze near grazing."""
    cosines = np.linspace(0.05, 1.0, 20)
    solved = lamina.solve(Stack([], metals.conductor(name)), threads=1).reflectance(cosines)
    expected = np.clip([metal_colours.rec709(name, mu) for mu in cosines], 0.0, 1.0)
    np.testing.assert_allclose(solved, expected, atol=0.012)


def test_only_gold_leaves_the_gamut():
    found = {name: metal_colours.rec709(name, 1.0) for name in NAMES}
    assert [name for name, colour in found.items() if max(colour) > 1.0 or min(colour) < 0.0] == ["gold"]
    np.testing.assert_allclose(found["gold"], (1.0528, 0.7837, 0.3427), atol=1e-4)
    assert metals.conductor("gold").facing[0] == metals.conductor("gold").grazing[0] == 1.0


def test_presets_have_the_metals_colours():
    """Each metal of the library's materials is one of the table, and names its source."""
    known = {(metals.conductor(name).facing, metals.conductor(name).grazing): metals.source(name) for name in NAMES}
    found = [preset for preset in presets.entries()
             if isinstance(preset.stack.base, lamina.Conductor) and preset.stack.wavelengths is None]
    assert len(found) == 34
    for preset in found:
        assert known[preset.stack.base.facing, preset.stack.base.grazing] in preset.source


@pytest.mark.parametrize(("call", "says"), [
    (lambda: metals.reflectance(math.nan, 1.0, 1.0), r"mu = nan: must lie in \[0, 1\]"),
    (lambda: metals.reflectance(-1.0, 1.0, 1.0), r"mu = -1: must lie in \[0, 1\]"),
    (lambda: metals.reflectance(1.0, "x", 1.0), "eta = 'x': must be one number"),
    (lambda: metals.reflectance(1.0, 1.0, math.inf), "k = inf: must lie in"),
    (lambda: metals.reflectance(1.0, 1e308, 1.0), r"eta = 1e\+308: must lie in"),
    (lambda: metals.indices_of(3, 1, "x"), "metal = 3: must be a lamina.Conductor or lamina.Flakes"),
    (lambda: metals.indices_of(metals.conductor("gold"), 0, "x"), "channels = 0: must be a whole number from 1 to"),
    (lambda: metals.indices_of(lamina.Conductor(facing="red", grazing=0.9), 3, "base"), "base.facing = 'red': must be"),
])
def test_bad_numbers_of_metals(call, says):
    with pytest.raises(ValueError, match=f"^{says}"):
        call()


def test_the_ends_of_fresnels_law():
    assert metals.reflectance(0.0, 0.2, 3.0) == pytest.approx(1.0)
    assert metals.reflectance(1.0, 0.0, 0.0) == pytest.approx(1.0)
    assert metals.reflectance(0.5, 1.0, 0.0) == 0.0


def test_stacks_with_indices_keep_their_meaning():
    """A stack that was saved with indices at three wavelengths is read as before."""
    base = {"kind": "conductor", "eta": [0.2141, 0.4547, 1.332], "k": [3.251, 2.406, 1.869], "alpha": 0.1}
    stack = Stack.from_json({"schema": 1, "layers": [], "base": base})
    assert stack.to_json()["base"] == base
    assert [stack.indices(c) for c in range(3)] == list(zip(base["eta"], base["k"], strict=True))
    assert math.isclose(metals.colours_of(stack.base)[0][0], metals.reflectance(1.0, 0.2141, 3.251), rel_tol=1e-12)
