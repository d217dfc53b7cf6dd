# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers of flakes in the panel: words, forms, the thickness that varies, the node group."""

import pytest
from addon_helpers import drawn_layer


@pytest.fixture
def flakes(addon, material):
    return addon.editing.layer_list.add_layer(material, "flakes")


def test_an_artists_words(addon, flakes):
    lines = drawn_layer(addon, flakes)
    for word in ("Amount", "Spread", "Flake Color", "Varying"):
        assert word in lines
    assert "Facing" not in lines
    flakes.flake_form = "metal"
    assert {"Facing", "Grazing"} <= set(drawn_layer(addon, flakes))
    assert "Flake Color" not in drawn_layer(addon, flakes)


def test_a_metal_by_its_spectrum(addon, material, flakes):
    flakes.flake_form, flakes.metal = "spectrum", "copper"
    assert "Metal" in drawn_layer(addon, flakes)
    stack = addon.editing.stack_io.to_stack(material)
    layer = next(layer for layer in stack.to_json()["layers"] if layer["kind"] == "flakes")
    assert layer["metal"] == "copper"
    addon.editing.stack_io.assign_stack(material, stack)
    again = next(layer for layer in material.lamina.layers if layer.kind == "flakes")
    assert (again.flake_form, again.metal) == ("spectrum", "copper")
    assert addon.editing.stack_io.to_stack(material).hash == stack.hash


def test_pearl(addon, material, flakes):
    flakes.pearl = True
    assert "Pearl" in drawn_layer(addon, flakes)
    layer = next(one for one in addon.editing.stack_io.to_dict(material)["layers"] if one["kind"] == "flakes")
    assert layer["pearl"] is True
    addon.editing.stack_io.assign(material, addon.editing.stack_io.to_dict(material))
    assert next(one for one in material.lamina.layers if one.kind == "flakes").pearl
    flakes = next(one for one in material.lamina.layers if one.kind == "flakes")
    flakes.flake_form = "metal"
    assert "Pearl" not in drawn_layer(addon, flakes)


def test_facts_in_the_list(addon, flakes):
    flakes.flake_tau, flakes.flake_alpha = 0.8, 0.15
    assert addon.ui.fields.facts(flakes) == "amount 0.8, spread 0.15"


def test_errors_in_an_artists_words(addon, material, flakes):
    flakes.name = "Silver"
    index = list(material.lamina.layers).index(flakes)
    text = addon.base.messages.in_panel_words(f"layers[{index}].alpha = 0.05: must lie in [0.1, 1]", material)
    assert text == f"Layer {index + 1} “Silver”, spread of flakes = 0.05: must lie in [0.1, 1]"


def test_one_thickness_varies(addon, material, flakes):
    medium = addon.editing.layer_list.add_layer(material, "medium")
    coat = addon.editing.layer_list.add_layer(material, "interface")
    coat.varying = True
    medium.varying = True
    flakes = next(layer for layer in material.lamina.layers if layer.kind == "flakes")
    flakes.varying = True
    kinds = {layer.kind: layer.varying for layer in material.lamina.layers}
    assert kinds == {"flakes": True, "medium": False, "interface": True}


def test_the_place_of_flakes(addon, material, flakes):
    place = addon.scene.place
    assert set(place.choices(flakes)) == {place.EVEN, place.PAINTED}
    assert place.of(material, flakes) == place.EVEN


def layer_of(addon, material):
    return next(one for one in addon.editing.stack_io.to_dict(material)["layers"] if one["kind"] == "flakes")


def test_interference(addon, material, flakes):
    flakes.flake_form = "film"
    assert {"Film Thickness (nm)", "Film Index", "Platelet Index"} <= set(drawn_layer(addon, flakes))
    assert "Flake Color" not in drawn_layer(addon, flakes)
    flakes.coat_film_thickness = 95.0
    entry = layer_of(addon, material)
    assert (entry["ior"], entry["film"]) == (1.58, [{"ior": 2.5, "thickness": 95.0}])
    stack = addon.editing.stack_io.to_stack(material)
    assert stack.wavelengths is not None
    addon.editing.stack_io.assign_stack(material, stack)
    again = next(layer for layer in material.lamina.layers if layer.kind == "flakes")
    assert (again.flake_form, again.coat_film_thickness, again.coats_text) == ("film", 95.0, "")
    assert addon.editing.stack_io.to_stack(material).hash == stack.hash


def test_platelets_without_a_film(addon, material, flakes):
    flakes.flake_form, flakes.coat_film_thickness = "film", 0.0
    stack = addon.editing.stack_io.to_stack(material)
    assert "film" not in layer_of(addon, material) and stack.wavelengths is None
    flakes.coat_film_thickness = 50.0
    addon.editing.stack_io.assign_stack(material, stack)
    assert addon.editing.stack_io.to_stack(material).hash == stack.hash


@pytest.mark.parametrize("entry", [
    {"ior": 1.58, "film": [{"ior": 1.46, "thickness": 100.0}, {"ior": 2.5, "thickness": 120.0}]},
    {"metal": "aluminium", "film": [{"ior": 1.46, "thickness": 200.0}]},
])
def test_films_that_the_panel_keeps_as_they_are(addon, material, flakes, entry):
    data = addon.editing.stack_io.to_dict(material)
    place = next(k for k, one in enumerate(data["layers"]) if one["kind"] == "flakes")
    data["layers"][place] = {"kind": "flakes", "name": "Pigment", "tau": 1.0, "alpha": 0.2, **entry}
    addon.editing.stack_io.assign(material, data)
    flakes = next(one for one in material.lamina.layers if one.kind == "flakes")
    assert layer_of(addon, material)["film"] == entry["film"]
    assert f"Imported: {len(entry['film'])} film" in " ".join(drawn_layer(addon, flakes))
    material.lamina.active_layer = place
    assert addon.stack_json.coats.imported(flakes)
    addon.stack_json.coats.replace(flakes)
    assert not addon.stack_json.coats.imported(flakes)


def test_a_film_with_an_index_by_wavelength(addon, material, flakes):
    """The panel keeps the index and edits the thickness."""
    data = addon.editing.stack_io.to_dict(material)
    place = next(k for k, one in enumerate(data["layers"]) if one["kind"] == "flakes")
    film = {"ior": {"wavelengths": [400.0, 700.0], "values": [2.8, 2.5]}, "thickness": 110.0}
    data["layers"][place] = {"kind": "flakes", "name": "Pigment", "tau": 1.0, "alpha": 0.2, "ior": 1.58, "film": [film]}
    addon.editing.stack_io.assign(material, data)
    flakes = next(one for one in material.lamina.layers if one.kind == "flakes")
    assert layer_of(addon, material)["film"] == [film]
    lines = drawn_layer(addon, flakes)
    assert "Imported: index by wavelength" in lines and "Film Thickness (nm)" in lines and "Film Index" not in lines
    flakes.coat_film_thickness = 90.0
    assert layer_of(addon, material)["film"] == [{**film, "thickness": 90.0}]
    assert film["thickness"] == 110.0


def test_damaged_films_are_refused(addon, material, flakes):
    flakes.flake_form, flakes.coats_text = "film", "[{"
    with pytest.raises(addon.base.native.require().StackError, match=r"film = 'unreadable': must be a Film"):
        addon.editing.stack_io.to_stack(material)
