# SPDX-License-Identifier: GPL-3.0-or-later
"""Pigments in place of colors: edited in the panel, and baked over plain bases and materials."""

import numpy as np
import pytest
from addon_helpers import drawn_layer

from lamina.colours import rec709


def pigment_layer(material, pigment="oxyhemoglobin"):
    layer = material.lamina.layers[0]
    layer.mode, layer.pigment, layer.amount = "pigment", pigment, 0.05
    layer.sigma_s, layer.thickness = (2.0, 2.0, 2.0), 0.5
    return layer


def test_a_pigment_is_baked_over_a_color(addon, lamina, material):
    pigment_layer(material)
    material.lamina.base.reflectance = (0.8, 0.6, 0.4)
    table = addon.baking.bake_job.bake_material(material)
    stack = addon.editing.stack_io.to_stack(material)
    assert stack.wavelengths == lamina.WAVELENGTHS and addon.baking.bake_job.state(material) == "fresh"
    wanted = rec709(lamina.solve(stack, "preview").reflectance(0.7), stack.wavelengths)
    assert table.reflectance(0.7) == pytest.approx(wanted, rel=2e-3)
    material.lamina.layers[0].amount = 0.1
    assert addon.baking.bake_job.state(material) != "fresh"


def test_the_color_of_a_thick_layer_is_told(addon, lamina, material):
    """And a pigment has no other numbers: no bottom of its own, no optical thickness."""
    layer = pigment_layer(material, "chlorophyll")
    layer.graded = True
    colours = addon.stack_json.solved_colours
    colours.thick_colour(layer)
    while colours.look() is not None:
        pass
    red, green, blue = colours.thick_colour(layer)
    assert green > max(red, blue)
    shown = " ".join(drawn_layer(addon, layer))
    assert "Pigment" in shown and "Amount" in shown and "As Thick Layer" in shown
    assert "Changes with Depth" not in shown and "Per Channel" not in shown
    assert "profile" not in addon.editing.stack_io.to_dict(material)["layers"][0]


def test_a_pigment_gets_thicker_where_it_settles(addon, material):
    layer = pigment_layer(material)
    place = addon.scene.place
    assert place._range(layer) == pytest.approx(1.0)
    place._raise_range(layer, 4.0)
    assert place._range(layer) == pytest.approx(4.0) and layer.thickness == pytest.approx(2.0)


@pytest.mark.parametrize("id", ["blood", "red-oxide-on-steel"])
def test_presets_with_pigments_are_edited_and_kept(addon, lamina, material, id):
    addon.editing.presets.apply(material, id)
    assert addon.editing.stack_io.to_stack(material).hash == lamina.presets.load(id).hash
    assert "wavelengths" not in addon.editing.stack_io.to_dict(material)
    assert material.lamina.layers[1].mode == "pigment"
    assert np.isfinite(addon.baking.bake_job.bake_material(material).weights).all()


def test_a_pigment_lies_over_a_principled_material(addon, lamina, material):
    pigment_layer(material)
    material.lamina.base.kind = "principled"
    table = addon.baking.bake_job.bake_material(material)
    assert addon.baking.bake_job.state(material) == "fresh"
    stack = addon.editing.stack_io.to_stack(material)
    wanted = stack.seen(lamina.solve(stack, "preview").reflectance(0.7))
    assert table.reflectance(0.7) == pytest.approx(wanted, rel=5e-3)


def test_the_light_under_which_pigments_are_seen(addon, lamina, material):
    """It counts only where spectra are, is baked, and survives a round trip; a light of one's own is refused."""
    mark = addon.editing.layer_list.mark
    before = mark(material)
    material.lamina.illuminant = "A"
    assert "illuminant" not in addon.editing.stack_io.to_dict(material) and mark(material) == before
    pigment_layer(material)
    data = addon.editing.stack_io.to_dict(material)
    assert data["illuminant"] == "A" and addon.editing.stack_io.to_stack(material).illuminant == "A"
    warm = addon.baking.bake_job.bake_material(material).reflectance(0.7)
    before = mark(material)
    material.lamina.illuminant = "D65"
    assert mark(material) != before, "for the results of the panel Depth"
    assert addon.baking.bake_job.state(material) != "fresh"
    assert warm[0] > addon.baking.bake_job.bake_material(material).reflectance(0.7)[0] + 0.005
    addon.editing.stack_io.assign(material, data)
    assert material.lamina.illuminant == "A" and addon.editing.stack_io.to_dict(material) == data
    with pytest.raises(addon.base.messages.RefusedError, match="one of the list, not a spectrum"):
        addon.editing.stack_io.assign(material, {**data, "illuminant": {"wavelengths": [500], "values": [1]}})


def test_what_faded_is_told(addon, material):
    layer = pigment_layer(material)
    layer.amount, layer.sigma_s, layer.thickness = 1.0, (1.0, 1.0, 1.0), 0.2
    material.lamina.base.reflectance = (0.8, 0.8, 0.8)
    assert addon.baking.bake_job.bake_material(material).report["faded"] > 0.0
    assert "Faded into Gamut" in dict(addon.ui.numbers.result_lines(material.lamina.result))


def test_a_pigment_in_depth(addon, lamina, material):
    """The panel Depth is there, and Soft and Exact take the pigment, by the color of its spectrum."""
    layer = pigment_layer(material)
    layer.infinite = True
    assert addon.editing.depth.has_lengths(material)
    stack = addon.editing.stack_io.to_stack(material)
    inputs = addon.baking.lateral_job.make(material, output="RELIGHTABLE")
    wanted = stack.seen(lamina.searchlight(stack, quality="preview").reflectance)
    assert inputs.albedo == pytest.approx(wanted, rel=2e-3)
    volume = addon.baking.lateral_job.make(material, output="VOLUME")
    contents = addon.interior.contents._of_layers(lamina, material)[0]
    assert volume.medium == contents.palette[0]
    assert volume.medium.sigma_a[0] < min(volume.medium.sigma_a[1:])
