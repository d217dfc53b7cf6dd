# SPDX-License-Identifier: GPL-3.0-or-later
"""The few closures for a real-time engine: directional albedo and height of the lobe, against the solver."""

import numpy as np
import pytest

import lamina
from lamina import Conductor, HenyeyGreenstein, Interface, Lambert, Medium, Stack, presets
from lamina.baking.table.real_time import KINDS, few_closures
from lamina.closures.closure_table import view_cosines
from lamina.kinds.table import Strip

DUST = Medium(albedo=[0.9, 0.8, 0.6], tau=1.0, phase=HenyeyGreenstein(0.6))
GOLD = Conductor(eta=[0.14, 0.37, 1.44], k=[3.98, 2.38, 1.60], alpha=0.2)
# Views up to 84 degrees: the table's columns are exact there, and the solver's values smooth.
COLUMNS = [0, 10, 25, 40, 50, 59]


@pytest.mark.parametrize("stack", [
    Stack([DUST], base=Lambert([0.5, 0.3, 0.1])), Stack([DUST], base=GOLD), presets.load("candy-apple-paint"),
    presets.load("snow-fresh"),
], ids=["dust", "dusty gold", "paint", "snow"])
def test_albedo(stack):
    """The strips add up to what the stack reflects, at every view and in every channel."""
    table = few_closures(lamina.bake(stack, "preview"))
    solved = lamina.solve(stack)
    for column in COLUMNS:
        found = table.texels[0, :, 0, column, :3].sum(axis=0)
        assert found == pytest.approx(np.asarray(solved.reflectance(float(view_cosines()[column]))), rel=4e-3)


@pytest.mark.parametrize("name", ["leaf", "frosted-glass"])
def test_albedo_of_a_sheet(name):
    """Reflected and transmitted light of both sides together."""
    stack = presets.load(name)
    table = few_closures(lamina.bake(stack, "preview"))
    solved = lamina.solve(stack)
    for side, place in (("top", 0), ("bottom", 1)):
        for column in COLUMNS:
            mu = float(view_cosines()[column])
            total = solved.reflectance(mu, side=side) + solved.transmittance(mu, side=side)
            assert table.texels[place, :, 0, column, :3].sum(axis=0) == pytest.approx(np.asarray(total), rel=1e-2)


def test_height_of_the_highlight():
    """A rough metal's lobe is as high as the solver's, seen from above, and lies in one strip."""
    table = few_closures(lamina.bake(Stack([], base=GOLD), "preview"))
    glossy = table.texels[0, table.strips.index(Strip("glossy")), 0, 0]
    height = glossy[:3] / (4.0 * np.pi * glossy[3] ** 4)
    assert height == pytest.approx(lamina.solve(Stack([], base=GOLD)).brdf(1.0, 1.0, 0.0), rel=0.02)


def test_a_smooth_coat_stays_sharp():
    """The mirror of a smooth varnish does not narrow the lobe of the rough metal below."""
    table = few_closures(lamina.bake(Stack([Interface(ior=1.5)], base=GOLD), "preview"))
    roughness = {strip.name: table.texels[0, place, 0, 0, 3] for place, strip in enumerate(table.strips)}
    assert roughness["mirror"] < 0.1 and 0.3 < roughness["glossy"] < 0.6


def test_strips_of_a_colored_base_keep_their_role():
    base = lamina.PrincipledBase(color=[0.5, 0.3, 0.1], roughness=0.5, inputs=("color", "metallic"))
    table = few_closures(lamina.bake(Stack([DUST], base=base), "preview"))
    names = [strip.name for strip in table.strips]
    for name in names:
        assert name.removeprefix("metal/").removeprefix("base/") in KINDS
    assert any(name.startswith("metal/") for name in names)
    assert any(name.startswith("base/") for name in names)
    assert np.isfinite(table.texels).all() and (table.texels >= 0.0).all() and (table.texels[..., 3] <= 1.0).all()


def test_eevees_transparency_is_grey():
    """Colored unscattered light is split into a grey part, which Eevee can show, and a narrow lobe straight on."""
    lut = lamina.bake(Stack([Medium(albedo=0.5, tau=[0.2, 0.5, 1.0])]), "preview")
    table = few_closures(lut)
    grey, colored = (table.texels[0, table.strips.index(Strip(name)), 0] for name in ("transparent", "straight"))
    unscattered = lut.weights[0, lut.closures.index("transparent"), 0]
    assert np.all(grey[:, :3] == grey[:, :1]) and np.all(colored[:, :3].min(axis=-1) == 0.0)
    assert grey[:, :3] + colored[:, :3] == pytest.approx(unscattered)
    white = few_closures(lamina.bake(Stack([Medium(albedo=0.5, tau=0.5)]), "preview"))
    assert Strip("straight") not in white.strips
