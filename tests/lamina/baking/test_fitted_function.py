# SPDX-License-Identifier: GPL-3.0-or-later
"""The fitted function outside Blender: its values against the solver and against a sum by hand, and its errors against
the report that the bake wrote."""

import functools

import numpy as np
import pytest

import lamina
from lamina import (
    ArgumentError,
    Black,
    HenyeyGreenstein,
    Interface,
    Lambert,
    Lut,
    Medium,
    PrincipledBase,
    ShaderBase,
    Stack,
)
from lamina.closures.axes import column_angles, tau_rows
from lamina.common.fresnel import fresnel

DUST = Medium(albedo=[0.9, 0.8, 0.6], tau=1.5, phase=HenyeyGreenstein(0.3), varying=True)
STACKS = {
    "unequal sheet": Stack([Medium(0.9, 0.5, HenyeyGreenstein(0.5)), Medium([0.3, 0.5, 0.9], 1.0)]),
    "varnish": Stack([Interface(1.5, 0.1), Medium([0.9, 0.8, 0.6], 1.0)], Lambert([0.5, 0.3, 0.1])),
    "satin": Stack([Interface(1.5, 0.02), Medium([0.9, 0.8, 0.6], 1.0)], Lambert([0.5, 0.3, 0.1])),
    "dust": Stack([DUST], Lambert([0.5, 0.3, 0.1])),
    "textured": Stack([DUST], Lambert([0.5, 0.3, 0.1], textured=True)),
    "shader": Stack([DUST], ShaderBase([0.5, 0.3, 0.1])),
    "principled": Stack([DUST], PrincipledBase([0.5, 0.3, 0.1], metallic=0.3, roughness=0.3)),
}
RANDOM = np.random.default_rng(3)
MU_O, MU_I = RANDOM.uniform(0.2, 1.0, (2, 300))
DPHI = RANDOM.uniform(0.0, 6.3, 300)


@functools.cache
def baked(name):
    return lamina.bake(STACKS[name], "preview")


def distance(found, exact):
    """L2 distance of cosine-weighted values, relative to the exact ones."""
    return np.linalg.norm((found - exact) * MU_I[:, None]) / np.linalg.norm(exact * MU_I[:, None])


def test_a_sheet_is_seen_from_the_right_side():
    """Fit errors are below 5 % by reflection and 15 % by transmission; the functions of the two sides are further
    apart."""
    lut, exact = baked("unequal sheet"), lamina.solve(STACKS["unequal sheet"])
    for side in ("top", "bottom"):
        assert distance(lut.evaluate(MU_O, MU_I, DPHI, side=side), exact.brdf(MU_O, MU_I, DPHI, side)) < 0.05
        found = lut.evaluate(MU_O, MU_I, DPHI, path="transmit", side=side)
        assert distance(found, exact.btdf(MU_O, MU_I, DPHI, side)) < 0.17
        assert lut.reflectance(MU_O, side) == pytest.approx(exact.reflectance(MU_O, side), rel=2e-3)
        spread, unscattered = lut.transmittance(MU_O, side, parts=True)
        diffuse, direct = exact.transmittance(MU_O, side, parts=True)
        assert unscattered == pytest.approx(direct, abs=2e-4) and spread == pytest.approx(diffuse, rel=0.03)
    apart = exact.brdf(MU_O, MU_I, DPHI), exact.brdf(MU_O, MU_I, DPHI, "bottom")
    assert distance(*apart) > 0.3


@pytest.mark.parametrize("name", ["varnish", "dust", "principled"])
def test_values_are_those_of_the_stack_within_the_fit_error(name):
    stack, lut = STACKS[name], baked(name)
    exact = lamina.solve(stack)
    assert distance(lut.evaluate(MU_O, MU_I, DPHI), exact.brdf(MU_O, MU_I, DPHI)) < 0.03
    assert lut.reflectance(MU_O) == pytest.approx(exact.reflectance(MU_O), rel=6e-3)


def test_a_sum_by_hand():
    """At a texel the value is the sum of weights times closures over the cosine; half-way it is that of mean weights.
    Closures are evaluated by their own formulas (lamina.lobes)."""
    lut = baked("dust")
    angles, taus = column_angles(), tau_rows(1.5)
    for column, row in ((7, 4), (40, 32)):
        for half in (0.0, 0.5):
            mu = np.cos(angles[column] + half * (angles[1] - angles[0]))
            strips = lut.weights[0, :, row].astype(float)
            weights = (1.0 - half) * strips[:, column] + half * strips[:, column + 1]
            by_hand = sum(weight * lamina.lobes.by_id(name).evaluate(mu, 0.6, 2.0)
                          for name, weight in zip(lut.closures, weights, strict=True)) / 0.6
            assert lut.evaluate(mu, 0.6, 2.0, tau=taus[row]) == pytest.approx(by_hand, rel=1e-9)


def test_arrays_broadcast():
    lut = baked("dust")
    values = lut.evaluate(MU_O[:4, None, None], MU_I[:5, None], DPHI[:6])
    assert values.shape == (4, 5, 6, 3)
    assert values[1, 2, 3] == pytest.approx(lut.evaluate(MU_O[1], MU_I[2], DPHI[3]), rel=1e-12)
    assert lut.evaluate(0.5, 0.5, 1.0, tau=[0.1, 0.7]).shape == (2, 3)
    assert lut.reflectance([0.3, 1.0], tau=[[0.1], [0.2]]).shape == (2, 2, 3)


def test_inputs_of_the_node_group():
    """A thickness and a color that the stack does not have."""
    lut = baked("textured")
    thin = lamina.solve(Stack([Medium(DUST.albedo, 0.3, DUST.phase)], Lambert([0.1, 0.8, 0.4])))
    assert distance(lut.evaluate(MU_O, MU_I, DPHI, tau=0.3, color=[0.1, 0.8, 0.4]), thin.brdf(MU_O, MU_I, DPHI)) < 0.03
    assert lut.reflectance(MU_O, tau=0.3, color=[0.1, 0.8, 0.4]) == pytest.approx(thin.reflectance(MU_O), rel=2e-3)


def test_without_dust_a_principled_base_is_itself():
    bare = lamina.solve(Stack([], STACKS["principled"].base))
    found = baked("principled").evaluate(MU_O, MU_I, DPHI, tau=0.0)
    assert found == pytest.approx(bare.brdf(MU_O, MU_I, DPHI), rel=1e-6)


def test_mirrors_with_a_width_count():
    lut = baked("satin")
    assert "mirror:0.02" in lut.closures
    peak = fresnel(0.7, 1.5) / (4.0 * np.pi * 0.02**2 * 0.7**2)  # of GGX facets that hide each other hardly
    assert lut.evaluate(0.7, 0.7, 0.0)[0] == pytest.approx(peak, rel=0.02)
    # The closure also has the light that the stack gains by facets of this width in place of a mirror.
    smooth = Stack([Interface(1.5), *STACKS["satin"].layers[1:]], STACKS["satin"].base)
    exact = lamina.solve(STACKS["satin"]).reflectance(1.0)
    gained = exact - lamina.solve(smooth).reflectance(1.0)
    assert lut.reflectance(1.0, parts=True)[1] == pytest.approx(0.04 + gained, abs=1e-5)
    assert lut.reflectance(1.0) == pytest.approx(exact, rel=1e-4)


@pytest.mark.parametrize("name", ["unequal sheet", "varnish", "dust", "textured", "shader", "principled"])
def test_a_comparison_finds_the_errors_of_the_report(name, tmp_path):
    lut = baked(name)
    lut.save(tmp_path / "lut.npz")
    compared = Lut.load(tmp_path / "lut.npz").compare()
    for ending in ("", "_transmission"):
        key = f"slice_errors{ending}"
        if lut.report[key] is not None:
            assert np.array(compared.report[key]) == pytest.approx(np.array(lut.report[key]), abs=3e-6)
    assert compared.mean == pytest.approx(lut.report["fit_error"], abs=1e-6) and 0.0 < compared.mean < 0.1
    assert compared.worst["mu_o"] == lut.report["worst_slice"]["mu_o"]
    assert compared.errors["reflection"].shape[2:] == (3, 64) == (3, *compared.angles.shape)


def test_another_stack_is_further_away():
    lut = baked("dust")
    other = Stack([Medium(0.5, 1.5, varying=True)], Lambert(0.3))
    assert lut.compare(other).mean > 5.0 * lut.compare().mean


def test_a_weight_that_was_changed_is_noticed():
    lut = baked("varnish")
    changed = Lut(lut.header, lut.weights * np.float32(1.02))
    assert changed.compare().mean > lut.report["fit_error"] + 0.005


@pytest.mark.parametrize(("call", "sentence"), [
    (lambda: baked("dust").evaluate(0.0, 0.5, 1.0), "mu_o = 0: must lie in (0, 1]"),
    (lambda: baked("dust").evaluate(0.5, 0.5, 1.0, tau=2.0), "tau = 2: must lie in [0, 1.5]"),
    (lambda: baked("varnish").evaluate(0.5, 0.5, 1.0, tau=1.0), "tau: must be left out"),
    (lambda: baked("dust").evaluate(0.5, 0.5, 1.0, color=0.5), "color: must be left out"),
    (lambda: baked("textured").evaluate(0.5, 0.5, 1.0, color=1.5), "color = 1.5: must be one number or three"),
    (lambda: baked("dust").evaluate(0.5, 0.5, 1.0, path="transmit"), "path = 'transmit': must not be asked"),
    (lambda: baked("dust").evaluate(0.5, 0.5, 1.0, path="up"), "path = 'up': must be 'reflect' or 'transmit'"),
    (lambda: baked("dust").reflectance(0.5, side="bottom"), "side = 'bottom': must not be asked"),
    (lambda: baked("dust").compare(STACKS["varnish"]), "stack: the table's stack has a varying layer"),
    (lambda: baked("varnish").compare(STACKS["unequal sheet"]), "stack: the given stack is a thin sheet"),
    (lambda: baked("dust").compare(Stack([Medium(0.5, 9.0, varying=True)], Black())), "layers[0].tau = 9: must be 1.5"),
    (lambda: baked("dust").compare("no such thing"), "stack = 'no such thing': must be"),
])
def test_bad_arguments_get_a_sentence(call, sentence):
    with pytest.raises(ArgumentError) as caught:
        call()
    assert str(caught.value).startswith(sentence) and "\n" not in str(caught.value)


def test_one_width_for_all_channels():
    """A list of widths was accepted, and failed with a TypeError in the bake."""
    with pytest.raises(lamina.StackError, match=r"layers\[0\].alpha = .*: must be one number for all channels"):
        Stack([Interface(1.5, [0.1, 0.2, 0.3])], Black())
