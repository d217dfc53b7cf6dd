# SPDX-License-Identifier: GPL-3.0-or-later
"""A varying interface: what is left without its film, and the table that holds both."""

import functools
import itertools
import json

import numpy as np
import pytest

import lamina
from lamina import Conductor, HalfSpace, Interface, Lambert, Lut, LutError, Medium, PrincipledBase, ShaderBase, Stack
from lamina.baking.bases.choice import largest_size
from lamina.baking.report.words import describe

WATER = Interface(1.33, varying=True)
MUD = Medium(albedo=[0.8, 0.7, 0.5], tau=0.6)
VARNISH, PAINT = Interface(1.5, alpha=0.2), Medium(albedo=0.9, tau=4.0)
DUST = Medium(albedo=[0.9, 0.8, 0.6], tau=2.0, varying=True)
SOIL = Lambert([0.3, 0.25, 0.2])
MU, DPHI = np.array([0.95, 0.6, 0.2]), np.array([0.3, 1.5, 2.9])


@pytest.mark.parametrize(("layers", "base", "left"), [
    ([WATER], SOIL, []),
    ([WATER, MUD], SOIL, []),
    ([WATER, MUD, PAINT], SOIL, []),
    ([DUST, WATER, MUD], SOIL, [DUST]),
    ([WATER, MUD, VARNISH, PAINT], SOIL, [VARNISH, PAINT]),
    ([VARNISH, PAINT, WATER, MUD, Interface(1.7)], SOIL, [VARNISH, PAINT, Interface(1.7)]),
    ([VARNISH, PAINT, WATER, MUD, Interface(1.5), PAINT], SOIL, [VARNISH, PAINT, PAINT]),  # water in a crack
    ([WATER, MUD, Interface(1.0), PAINT], SOIL, [PAINT]),
    ([Interface([1.3, 1.4, 1.5], varying=True), VARNISH, PAINT], None, [VARNISH, PAINT]),
    ([WATER], Conductor(eta=0.3, k=3.0), []),
    ([WATER, PAINT], HalfSpace(0.9), []),
])
def test_what_is_left_without_the_film(layers, base, left):
    found = Stack(layers, base).uncovered
    assert (list(found.layers), found.base) == (left, base)


def test_nothing_is_left_of_a_film_in_air():
    bare = Stack([WATER, MUD, Interface(1.0)]).uncovered
    assert lamina.solve(bare).transmittance(MU) == pytest.approx(1.0)
    assert Stack([VARNISH, PAINT], SOIL).uncovered is None


def test_solvers_take_the_film_as_present():
    with_film, fixed = (Stack([Interface(1.33, varying=varies), MUD], SOIL) for varies in (True, False))
    assert np.array_equal(lamina.solve(with_film).brdf(MU, 0.7, DPHI), lamina.solve(fixed).brdf(MU, 0.7, DPHI))
    assert with_film.hash != fixed.hash and with_film.varying is None and with_film.covering == 0


def test_json_names_only_an_interface_that_varies():
    stack = Stack([DUST, WATER, VARNISH, PAINT], SOIL)
    entries = stack.to_json()["layers"]
    assert entries[1] == {"kind": "interface", "ior": 1.33, "alpha": 0.0, "varying": True}
    assert "varying" not in entries[2]
    assert Stack.from_json(json.loads(json.dumps(stack.to_json()))) == stack
    assert Stack.from_json(json.loads(stack.canonical())).hash == stack.hash
    assert "ior 1.33, varying" in stack._repr_html_()


@pytest.mark.parametrize("value", [1, "yes", None])
def test_varying_is_true_or_false(value):
    with pytest.raises(lamina.StackError, match=r"^layers\[0\].varying = .*: must be false or true$"):
        Stack([Interface(1.33, varying=value)], SOIL)


def test_only_one_interface_varies():
    with pytest.raises(lamina.StackError, match=r"^layers\[2\].varying = true: only one interface may vary$"):
        Stack([WATER, MUD, WATER], SOIL)


def test_a_film_whose_absence_no_table_holds():
    stack = Stack([Interface(1.5), PAINT, Interface(1.0, varying=True)])
    with pytest.raises(lamina.StackError, match=r"^layers\[2\].varying = true: without its film, layers end at index "):
        lamina.bake(stack, "preview")


STACKS = {
    "puddle": Stack([WATER, MUD], SOIL),
    "dust on a wet surface": Stack([DUST, WATER, VARNISH, PAINT], SOIL),
    "a puddle with dust in it": Stack([WATER, DUST], SOIL),
    "wet textured": Stack([WATER], Lambert([0.3, 0.25, 0.2], textured=True)),
    "varnish on Principled": Stack([Interface(1.5, varying=True)],
                                   PrincipledBase(color=[0.7, 0.3, 0.1], metallic=0.0, roughness=0.5,
                                                  inputs=("color",))),
    "a wet pane": Stack([WATER, Interface(1.5), Medium(albedo=0.5, tau=0.2), Interface(1.0)]),
    "a film in air": Stack([WATER, MUD, Interface(1.0)]),
}


@functools.cache
def bake(stack):
    """Of layers of varying thickness, every eighth thickness is solved."""
    return lamina.bake(stack, "preview", row_stride=1 if stack.varying is None else 8, threads=1)


@pytest.fixture(scope="module", params=STACKS)
def baked(request):
    stack = STACKS[request.param]
    return stack, bake(stack)


def test_the_table_holds_both_stacks(baked, tmp_path):
    """Bit for bit those of the bakes of each."""
    stack, lut = baked
    alone, fixed = bake(stack.uncovered), bake(Stack([_fixed(layer) for layer in stack.layers], stack.base))
    assert lut.uncovered == alone and lut.uncovered.report["fit_error"] == alone.report["fit_error"]
    assert np.array_equal(lut.weights, fixed.weights) and lut.closures == fixed.closures
    assert lut.header["report"] == fixed.header["report"] and lut.stack.hash == stack.hash
    assert describe(alone) in describe(lut)
    lut.save(tmp_path / "lut.npz")
    again = Lut.load(tmp_path / "lut.npz")
    assert again == lut and again.uncovered == lut.uncovered
    rows = lut.weights.shape[0] * lut.weights.shape[1] * lut.weights.shape[2]
    assert rows + alone.image().shape[0] <= largest_size(stack, "standard")[0]


def test_coverage_is_a_mixture(baked):
    """Exact at 0 and 1, and linear between, with and without a thickness."""
    stack, lut = baked
    paths = ("reflect", "transmit") if stack.base is None else ("reflect",)
    albedo = {"reflect": Lut.reflectance, "transmit": Lut.transmittance}
    for path, tau in itertools.product(paths, (None, 0.5) if stack.varying is not None else (None,)):
        bare = lut.uncovered
        own = tau if bare.header["axes"]["tau"]["count"] > 1 else None
        ends = bare.evaluate(MU, 0.7, DPHI, path, tau=own), lut.evaluate(MU, 0.7, DPHI, path, tau=tau)
        for coverage in (0.0, 1.0, 0.25):
            found = lut.evaluate(MU, 0.7, DPHI, path, tau=tau, coverage=coverage)
            expected = (1.0 - coverage) * ends[0] + coverage * ends[1]
            assert np.array_equal(found, expected), (path, tau, coverage)
        every = lut.evaluate(MU, 0.7, DPHI, path, tau=tau, coverage=[0.0, 0.5, 1.0])
        assert np.array_equal(every[0], ends[0][0]) and np.array_equal(every[2], ends[1][2])
        dry, wet = albedo[path](bare, MU, tau=own), albedo[path](lut, MU, tau=tau)
        assert albedo[path](lut, MU, tau=tau, coverage=0.5) == pytest.approx(0.5 * (dry + wet), rel=1e-12)


def test_coverage_zero_is_the_solved_stack_without_the_film():
    """A wet Lambert surface, in whose dry spots the table is Lambert's law."""
    lut = lamina.bake(STACKS["puddle"], "preview")
    dry = lut.evaluate(MU, 0.7, DPHI, coverage=0.0)
    assert dry == pytest.approx(np.broadcast_to(np.array(SOIL.reflectance) / np.pi, dry.shape), rel=2e-3)
    wet = lut.evaluate(MU, 0.7, DPHI)
    assert wet == pytest.approx(lamina.solve(STACKS["puddle"]).brdf(MU, 0.7, DPHI), rel=0.15)
    assert np.all(wet < dry)


def test_the_shader_below_is_whole_without_the_film():
    lut = lamina.bake(Stack([WATER, MUD], ShaderBase(0.5)), "preview")
    bare = lut.uncovered
    weight = bare.weights[:, bare.closures.index("base/weight")]
    assert weight == pytest.approx(1.0, abs=1e-6)
    rest = [k for k, name in enumerate(bare.closures) if name != "base/weight"]
    assert np.abs(bare.weights[:, rest]).max() < 1e-6


@pytest.mark.parametrize("coverage", [-0.1, 1.1, [0.5, 2.0], float("nan"), "half"])
def test_coverage_out_of_range(coverage):
    with pytest.raises(lamina.ArgumentError, match="^coverage"):
        lamina.bake(STACKS["puddle"], "preview").evaluate(0.5, 0.5, 0.0, coverage=coverage)


def test_a_table_without_coverage_refuses_one():
    lut = lamina.bake(Stack([VARNISH, PAINT], SOIL), "preview")
    assert lut.uncovered is None and lut.header["schema"] == 1 and "uncovered" not in lut.header
    with pytest.raises(lamina.ArgumentError, match="^coverage: must be left out, no interface of this table varies$"):
        lut.reflectance(0.5, coverage=1.0)


def test_damaged_second_tables_are_refused(tmp_path):
    lut = bake(STACKS["dust on a wet surface"])
    inner = lut.header["uncovered"]
    short = {**inner, "axes": {**inner["axes"], "tau": {**inner["axes"]["tau"], "values": [0.0] * 33}}}
    nested = {**inner, "schema": 2, "uncovered": inner}
    good = lut.uncovered_weights
    for header, weights, words in [
            ({**lut.header, "uncovered": {**inner, "closures": []}}, good, "uncovered: weights are "),
            ({**lut.header, "uncovered": short}, good, "uncovered: axes.tau must be that of the table"),
            ({**lut.header, "uncovered": nested}, good, "uncovered: uncovered: a table has its header"),
            ({**lut.header, "uncovered": 5}, good, "uncovered: not a Lamina lookup table"),
            (lut.header, good - 1.0, "uncovered: weights are negative"),
            (lut.header, None, "it has no array 'uncovered'")]:
        Lut(header, lut.weights, uncovered_weights=weights).save(tmp_path / "bad.npz")
        with pytest.raises(LutError, match=words):
            Lut.load(tmp_path / "bad.npz")


def test_progress_rises_through_both_bakes():
    seen = []
    lamina.bake(STACKS["puddle"], "preview", progress=lambda share, _: seen.append(share))
    assert seen == sorted(seen) and seen[0] == 0.0 and seen[-1] == 1.0 and any(0.5 < share < 1.0 for share in seen)


def test_live_bakes_keep_the_closures_with_the_film():
    lut = lamina.bake(STACKS["puddle"], "preview")
    changed = Stack([Interface(1.4, varying=True), MUD], SOIL)
    again = lamina.bake(changed, "preview", closures=lut.closures)
    assert again.closures == lut.closures and again.uncovered == lut.uncovered


def _fixed(layer):
    return Interface(layer.ior, layer.alpha, layer.distribution) if isinstance(layer, Interface) else layer
