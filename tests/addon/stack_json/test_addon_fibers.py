# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers of fibers, and retroreflectors, in the panel: words, facts, stacks written and read."""

import math

import pytest
from addon_helpers import drawn_layer


@pytest.fixture
def fibers(addon, material):
    return addon.editing.layer_list.add_layer(material, "fibers")


def test_an_artists_words(addon, fibers):
    lines = drawn_layer(addon, fibers)
    for word in ("Amount", "Lean", "Fiber Color", "Translucency", "Varying"):
        assert word in lines


def test_facts_in_the_list(addon, fibers):
    fibers.fiber_tau, fibers.fiber_tilt = 3.0, math.radians(20.0)
    assert addon.ui.fields.facts(fibers) == "amount 3, lean 20°"


def test_errors_in_an_artists_words(addon, material, fibers):
    fibers.name = "Pile"
    index = list(material.lamina.layers).index(fibers)
    text = addon.base.messages.in_panel_words(f"layers[{index}].tilt = 2: must lie in [.05, pi / 2] rad", material)
    assert text == f"Layer {index + 1} “Pile”, lean of fibers = 2: must lie in [.05, pi / 2] rad"


def test_the_place_of_fibers(addon, material, fibers):
    place = addon.scene.place
    assert set(place.choices(fibers)) == {place.EVEN, place.PAINTED}
    assert place.of(material, fibers) == place.EVEN


@pytest.mark.parametrize("name", ["velvet-red", "moss", "peach", "reflective-tape", "road-sign"])
def test_presets_are_read_and_written(addon, material, lamina, name):
    addon.editing.presets.apply(material, name)
    wanted, found = lamina.presets.load(name), addon.editing.stack_io.to_stack(material)
    assert found.canonical() == wanted.canonical()
