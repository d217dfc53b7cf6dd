# SPDX-License-Identifier: GPL-3.0-or-later
"""The library of stacks: every one is complete, has a name and a source, and can be solved; the command that lists
them."""

import itertools
import json
from pathlib import Path

import numpy as np
import pytest

import lamina
from lamina import Interface, Medium, Retroreflector, Stack, StackError, presets
from lamina.cli import main

CATEGORIES = {"Overlays", "Metals", "Liquids", "Skin and organics", "Stone and ceramics", "Coated and painted",
              "Dust and weathering", "Paper and leaves", "Snow and soil"}
IDS = presets.names()


def test_the_library():
    entries = presets.entries()
    assert [entry.id for entry in entries] == IDS == sorted(IDS) and len(IDS) >= 44
    assert {entry.category for entry in entries} == CATEGORIES
    assert len({entry.name for entry in entries}) == len({entry.stack.hash for entry in entries}) == len(entries)
    layered = [entry for entry in entries if len(entry.stack.layers) >= 2]
    assert len(layered) >= 18
    for category in CATEGORIES:
        assert sum(entry.category == category for entry in entries) >= 4


@pytest.mark.parametrize("id", IDS)
def test_a_preset(id):
    stack = presets.load(id)
    assert stack.name and stack.category in CATEGORIES and len(stack.source) > 20 and stack.source.endswith(".")
    assert stack.channels in (1, 3) or stack.wavelengths == lamina.WAVELENGTHS
    # Sources of measured values are given, and values that are not measured are marked.
    assert "by eye" in stack.source or any(word in stack.source for word in (
        "measured", "biosnicar", "prosail", "PROSPECT"))
    surfaces = [layer for layer in stack.layers if isinstance(layer, Interface)]
    for surface in [*surfaces, stack.base]:
        alpha = getattr(surface, "alpha", 0.0)
        # Tables are worse for narrow facets, but not for a retroreflector's lobe about the viewer
        assert alpha == 0.0 or alpha >= (0.05 if isinstance(surface, Retroreflector) else 0.08)
    for index, channel in itertools.product(range(len(stack.layers)), range(stack.channels)):
        if isinstance(stack.layers[index], Medium):
            assert stack.optics(index, channel)[1] <= 200.0
    solved = lamina.solve(stack, quality="preview")
    reflected, transmitted = solved.reflectance("diffuse"), solved.transmittance("diffuse")
    assert np.all(reflected > 0.01) and np.all(reflected + transmitted < 1.0 + 1e-4)
    assert (stack.base is None) == bool(np.any(transmitted > 1e-4))


@pytest.mark.parametrize("id", IDS)
def test_the_file_is_what_the_stack_says(id):
    text = (Path(presets.__file__).parent / "material/presets" / f"{id}.json").read_text(encoding="utf-8")
    assert Stack.from_json(presets.load(id).to_json()) == presets.load(id) == Stack.from_json(json.loads(text))


def test_overlays_are_layers_for_any_base():
    overlays = [entry.stack for entry in presets.entries() if entry.category == "Overlays"]
    assert len(overlays) == 20 and all(stack.base is None and stack.layers for stack in overlays)
    for stack in overlays:
        films = [layer for layer in stack.layers if isinstance(layer, Interface)]
        # What can settle varies. The layers change the light, and the material below is still seen.
        assert (stack.varying is None) == bool(films) and films in ([], [stack.layers[0]])
        grounds = [lamina.Lambert(reflectance) for reflectance in (0.1, 0.6)]
        solved = [lamina.solve(Stack(stack.layers, ground), "preview") for ground in grounds]
        dark, light = (one.reflectance("diffuse") for one in solved)
        assert np.max(light - dark) > 0.05, stack.name
        assert max(np.max(np.abs(dark - 0.1)), np.max(np.abs(light - 0.6))) > 0.02, stack.name


def test_measured_presets_are_the_measurements():
    """Jensen et al. (2001): whole milk scatters 2.55, 3.21, 3.77 and absorbs .0011, .0024, .014 a millimetre."""
    milk = presets.load("whole-milk")
    assert milk.base.sigma_s == (2.55, 3.21, 3.77) and milk.base.sigma_a == (0.0011, 0.0024, 0.014)
    assert milk.layers == (Interface(1.3, name="surface"),)
    gold = lamina.metals.conductor("gold", alpha=0.1)
    assert presets.load("gold").base == Stack([], gold).base


def test_the_leaf_shows_the_spectra_that_it_was_inverted_from():
    leaf = lamina.solve(presets.load("leaf"))
    np.testing.assert_allclose(leaf.reflectance(1.0), [0.0472, 0.1260, 0.0411], atol=2e-4)
    np.testing.assert_allclose(leaf.transmittance(1.0), [0.0586, 0.1922, 0.0027], atol=5e-4)


def test_the_pond_is_measured_water_in_which_silt_settles():
    """Pope and Fry (1997): water absorbs .34, .0565, .00922 per metre; 30 times as much silt lies at the bottom."""
    top, bottom = presets.load("silted-pond").layers[1].profile
    np.testing.assert_allclose(np.divide(bottom.sigma_s, top.sigma_s), 30.0, rtol=1e-9)
    water = (30.0 * np.array(top.sigma_a) - bottom.sigma_a) / 29.0
    np.testing.assert_allclose(1000.0 * water, [0.34, 0.0565, 0.00922], rtol=1e-9)


def test_layers_are_told_apart_by_name():
    for entry in presets.entries():
        found = [layer.name for layer in entry.stack.layers]
        assert all(found) and len(set(found)) == len(found), entry.id


def test_dust_has_a_thickness_input():
    grains = {"dust", "soot", "ash"}
    dusty = [entry for entry in presets.entries() if grains & {layer.name for layer in entry.stack.layers}]
    assert len(dusty) >= 7 and all(entry.stack.varying is not None for entry in dusty)


def test_an_unknown_preset():
    for kind in (KeyError, StackError):
        with pytest.raises(kind) as caught:
            presets.load("varnished-wallnut")
        assert str(caught.value).startswith(
            f"preset = 'varnished-wallnut': unknown; the nearest of {len(IDS)} are varnished-walnut, ")


class TestCommand:
    def test_list(self, capfd):
        assert main(["presets"]) == 0
        out, err = capfd.readouterr()
        lines = out.splitlines()
        assert err == "" and [line.split()[0] for line in lines] == IDS
        assert lines[IDS.index("varnished-walnut")].endswith("  varnish surface / varnish / lambert")
        assert "Coated and painted" in lines[IDS.index("varnished-walnut")]

    def test_list_as_json(self, capfd):
        assert main(["presets", "--json"]) == 0
        rows = json.loads(capfd.readouterr().out)
        assert [row["id"] for row in rows] == IDS and all(set(row) == {"id", "name", "category", "source", "stack"}
                                                          for row in rows)
        assert all(Stack.from_json(row["stack"]) == presets.load(row["id"]) for row in rows)

    @pytest.mark.parametrize("words", [("gold",), ("gold", "--json")])
    def test_one(self, words, capfd):
        assert main(["presets", *words]) == 0
        assert Stack.from_json(json.loads(capfd.readouterr().out)) == presets.load("gold")

    def test_unknown(self, capfd):
        assert main(["presets", "golt"]) == 2
        out, err = capfd.readouterr()
        assert out == "" and err.count("\n") == 1
        assert err.startswith("lamina: preset = 'golt': unknown; the nearest of ")
