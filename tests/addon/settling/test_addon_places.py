# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a layer lies: each place from each other one, what it bakes and feeds, and what it refuses."""

import importlib
import itertools
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from addon_helpers import drawn
from dusty_objects import NAME, grid

MEDIUM = ("EVEN", "SETTLED", "PAINTED", "IMAGE")
FILM = ("EVEN", "SETTLED", "PAINTED", "DROPS", "PUDDLES", "PRINTS")


@pytest.fixture
def place(addon, dust):
    return importlib.import_module(f"{addon.__package__}.scene.place")


@pytest.fixture
def plate(place, material):
    """A plate with one thin layer of dust, which does not vary and is not baked."""
    plate = grid(material=material)
    bpy.context.view_layer.objects.active = plate
    material.lamina.quality, material.lamina.layers[0].tau = "preview", 0.3
    return plate


def choose(plate, call, name):
    return call(bpy.ops.lamina.place, plate.active_material, place=name)


def socket(addon, material, name="Thickness"):
    return addon.nodes.thickness.wiring(material, name).socket


def test_one_click_settles_dust_on_a_thin_even_layer(addon, place, plate, material, call):
    layer = material.lamina.layers[0]
    assert place.of(material, layer) == "EVEN"
    assert choose(plate, call, "SETTLED") == {"FINISHED"}
    assert layer.varying and layer.tau == place.RANGE and addon.baking.bake_job.state(material) == "fresh"
    assert place.of(material, layer) == "SETTLED" and addon.nodes.thickness.wiring(material).name == NAME
    assert addon.ui.settled_fields.mismatch(material, plate.lamina_dust) == ""
    values = np.empty(len(plate.data.attributes[NAME].data), np.float32)
    plate.data.attributes[NAME].data.foreach_get("value", values)
    assert values.max() == pytest.approx(plate.lamina_dust.amount, rel=0.05)


@pytest.mark.parametrize(("first", "second"), list(itertools.permutations(MEDIUM, 2)))
def test_from_each_place_to_each_other(addon, place, plate, material, call, first, second):
    layer = material.lamina.layers[0]
    for name in (first, second, first):
        assert choose(plate, call, name) == {"FINISHED"}
        assert place.of(material, layer) == name
        thin = socket(addon, material)
        if name in ("EVEN", "PAINTED") and layer.varying:
            assert not thin.is_linked and 0.0 < thin.default_value <= place.USUAL, "never a layer that hides all"
    assert addon.baking.bake_job.state(material) == "fresh"


def test_settled_dust_varies_less_than_an_even_layer_of_a_preset(addon, place, plate, material, call):
    addon.editing.presets.apply(material, "dusty-lacquer")
    addon.baking.bake_job.bake_material(material)
    detail = addon.nodes.detail_wiring.detail(material)

    def strengths():
        return [round(detail.inputs[name].default_value, 6) for name in ("Clouds", "Grain")]

    even = strengths()
    choose(plate, call, "SETTLED")
    assert [after < before for before, after in zip(even, strengths(), strict=True)] == [True, True]
    detail.inputs["Clouds"].default_value = 0.2  # the artist's own
    settled = strengths()
    choose(plate, call, "EVEN")
    choose(plate, call, "SETTLED")
    assert strengths() == settled


def test_an_even_layer_keeps_its_thickness_when_it_is_painted(addon, place, plate, material, call):
    choose(plate, call, "PAINTED")
    assert socket(addon, material).default_value == pytest.approx(0.3)
    socket(addon, material).default_value = 0.2
    choose(plate, call, "EVEN")
    assert socket(addon, material).default_value == pytest.approx(0.2)


def test_the_painted_mask_comes_back(addon, place, plate, material, call):
    choose(plate, call, "PAINTED")
    image = addon.nodes.detail_wiring.mask(material).image
    choose(plate, call, "EVEN")
    assert addon.nodes.detail_wiring.mask(material) is None and image.use_fake_user
    choose(plate, call, "PAINTED")
    assert addon.nodes.detail_wiring.mask(material).image == image


def test_a_layer_per_millimetre_and_an_endless_one(place, plate, material, call):
    layer = material.lamina.layers[0]
    layer.mode, layer.sigma_s, layer.sigma_a, layer.thickness = "coefficients", (2.0, 1.0, 1.0), (0.0, 0.5, 0.0), 0.5
    choose(plate, call, "SETTLED")
    assert layer.thickness == pytest.approx(place.RANGE / 2.0)
    layer.varying, layer.infinite = False, True
    choose(plate, call, "IMAGE")
    assert layer.varying and not layer.infinite and place.of(material, layer) == "IMAGE"


def test_a_second_layer_takes_the_place_over(addon, place, plate, material, call):
    choose(plate, call, "SETTLED")
    other = addon.editing.layer_list.add_layer(material)
    other.tau = 0.1
    choose(plate, call, "SETTLED")
    layers = material.lamina.layers
    assert [layer.varying for layer in layers] == [layer.name == other.name for layer in layers]
    assert place.of(material, layers[material.lamina.active_index]) == "SETTLED"


def test_places_of_a_film(addon, place, plate, material, call):
    film = addon.editing.layer_list.add_layer(material, "interface")
    assert place.choices(film) == FILM and place.of(material, film) == "EVEN"
    with pytest.raises(RuntimeError, match="no place “Image”"):
        choose(plate, call, "IMAGE")
    choose(plate, call, "PAINTED")
    assert film.varying and place.of(material, film) == "PAINTED"
    painted = addon.nodes.thickness.wiring(material, "Coverage").node.image
    assert call(bpy.ops.lamina.film_paint, material) == {"FINISHED"} and plate.mode == "TEXTURE_PAINT"
    bpy.ops.object.mode_set(mode="OBJECT")
    assert bpy.context.tool_settings.image_paint.canvas == painted
    choose(plate, call, "EVEN")
    assert place.of(material, film) == "EVEN" and socket(addon, material, "Coverage").default_value == 1.0


def test_from_each_place_of_a_film_to_each_other(addon, place, plate, material, call):
    film = addon.editing.layer_list.add_layer(material, "interface")
    for first, second in itertools.combinations(FILM, 2):
        for name in (first, second, first):
            assert choose(plate, call, name) == {"FINISHED"}
            assert place.of(material, film) == name
            assert len([node for node in material.node_tree.nodes if node.type == "GROUP"]) <= 2
    assert addon.baking.bake_job.state(material) == "fresh"


def test_drops_where_dust_settles_and_where_they_are_painted(addon, place, plate, material, call):
    film = addon.editing.layer_list.add_layer(material, "interface")
    for name in ("DROPS", "SETTLED", "PAINTED"):
        choose(plate, call, name)
        assert addon.nodes.film_wiring.chosen(material) == "DROPS"
    choose(plate, call, "SETTLED")
    plate.lamina_dust.target = "image"
    addon.settling.object_dust.settle(bpy.context, plate)
    assert place.of(material, film) == "SETTLED", "the coverage follows the dust to an image"
    assert addon.nodes.thickness.wiring(material, "Coverage").source == "image"


def test_nodes_of_the_artist(addon, place, plate, material, call):
    choose(plate, call, "EVEN")
    choose(plate, call, "IMAGE")
    own = material.node_tree.nodes.new("ShaderNodeValue")
    material.node_tree.links.new(own.outputs[0], socket(addon, material))
    assert place.of(material, material.lamina.layers[0]) == ""
    choose(plate, call, "SETTLED")
    assert place.of(material, material.lamina.layers[0]) == "SETTLED"
    assert own.name in material.node_tree.nodes, "the node stays, the link is replaced"


def test_a_thin_film_is_even(addon, place, plate, material, call):
    film = addon.editing.layer_list.add_layer(material, "film")
    assert choose(plate, call, "EVEN") == {"FINISHED"}
    assert place.of(material, film) == "EVEN" and not film.varying
    with pytest.raises(RuntimeError, match="no place “Settled”"):
        choose(plate, call, "SETTLED")


def test_refused_with_nothing_changed(addon, place, plate, material, call):
    plate.data.materials.clear()
    for name in MEDIUM[1:]:
        with pytest.raises(RuntimeError, match="Select a mesh object that has this material"):
            call(bpy.ops.lamina.place, material, place=name)
    plate.data.materials.append(material)
    material.lamina.active_index = 5
    with pytest.raises(RuntimeError, match="The layer was removed meanwhile"):
        choose(plate, call, "SETTLED")
    assert not material.lamina.layers[0].varying and material.lamina.node_group is None


def test_edit_mode_is_refused(addon, place, plate, material, call):
    while plate.data.uv_layers:
        plate.data.uv_layers.remove(plate.data.uv_layers[0])
    bpy.ops.object.mode_set(mode="EDIT")
    for name in MEDIUM[2:]:
        with pytest.raises(RuntimeError, match="is being edited: leave Edit Mode"):
            choose(plate, call, name)
    assert not material.lamina.layers[0].varying and material.lamina.node_group is None
    material.lamina.layers[0].varying = True
    addon.baking.bake_job.bake_material(material)
    with pytest.raises(RuntimeError, match="is being edited: leave Edit Mode"):
        call(bpy.ops.lamina.dust_wipe, material, kept="attribute")
    bpy.ops.object.mode_set(mode="OBJECT")
    assert addon.settling.wiping.ATTRIBUTE not in plate.data.attributes and not plate.data.uv_layers


def test_dust_that_fails_changes_nothing(addon, lamina, place, plate, material, call, monkeypatch):
    def fail(*_args, **_how):
        raise lamina.DustError("the dust of this test fails")

    monkeypatch.setattr(addon.settling.object_dust, "settle_gathered", fail)
    with pytest.raises(RuntimeError, match="The dust of this test fails"):
        choose(plate, call, "SETTLED")
    layer = material.lamina.layers[0]
    assert not layer.varying and layer.tau == pytest.approx(0.3) and material.lamina.node_group is None


def test_a_cancelled_job_changes_nothing(addon, place, plate, material):
    """Dust on a subdivided mesh would be kept in an image, over a map that is unwrapped."""
    plate.modifiers.new("Subdivision", "SUBSURF").render_levels = 3
    for layer in list(plate.data.uv_layers):
        plate.data.uv_layers.remove(layer)
    job = place.start(bpy.context, material, "SETTLED")
    job.cancel()
    job.wait()
    assert job.finish() is None
    addon.settling.dust_job.forget()
    assert not material.lamina.layers[0].varying and NAME not in plate.data.attributes
    assert plate.lamina_dust.target == "attribute" and not plate.data.uv_layers


def test_the_job_of_a_window(addon, place, plate, material):
    """The artist may choose another layer and another object while it works."""
    addon.editing.layer_list.add_layer(material, "interface")
    material.lamina.active_index = 1
    for name, told in (("SETTLED", "Dust lies on Plate"), ("PAINTED", "Wipe by Hand")):
        job = place.start(bpy.context, material, name)
        job.wait()
        material.lamina.active_index, bpy.context.view_layer.objects.active = 0, None
        assert told in job.finish()
        addon.settling.dust_job.forget()
        material.lamina.active_index, bpy.context.view_layer.objects.active = 1, plate
        assert place.of(material, material.lamina.layers[1]) == name


def test_what_the_panel_offers(addon, place, plate, material, call):
    context = SimpleNamespace(
        preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)), region=SimpleNamespace(width=600),
        evaluated_depsgraph_get=bpy.context.evaluated_depsgraph_get, mode="OBJECT", object=plate, material=material,
        scene=bpy.context.scene,
    )  # fmt: skip

    def lines():
        panel = addon.ui.where_panel.LAMINA_PT_where
        return drawn(lambda layout: panel.draw(SimpleNamespace(layout=layout), context))

    names = ["Even", "Settled", "Painted", "Image"]
    assert lines() == names, "an even layer has its thickness in the panel Layers"
    choose(plate, call, "PAINTED")
    assert {"Optical Thickness", "Wipe by Hand"} <= set(lines())
    choose(plate, call, "SETTLED")
    assert {"Amount", "Slope", "Wind", "Settle Again", "More", "How Much", "Where From", "Where To"} <= set(lines())
    choose(plate, call, "IMAGE")
    assert "UV Map" in lines()


def test_an_image_and_an_even_thickness_come_back(addon, place, plate, material, call):
    """The image that an artist has chosen has a user all the time, and is fed again; so is the even thickness."""
    layer, thickness = material.lamina.layers[0], addon.nodes.thickness
    choose(plate, call, "IMAGE")
    new = thickness.wiring(material).node.image
    assert new.pixels[0] == pytest.approx(0.3), "the layer looks as before"
    own = bpy.data.images.new("mask", 8, 8, float_buffer=True, is_data=True)
    thickness.wiring(material).node.image = own
    for name in ("SETTLED", "PAINTED", "EVEN"):
        choose(plate, call, name)
        assert own.users == 1 and place.of(material, layer) == name
        choose(plate, call, "IMAGE")
        assert thickness.wiring(material).node.image == own and own.users == 1
    choose(plate, call, "EVEN")
    assert socket(addon, material).default_value == pytest.approx(0.3)


def test_each_layer_has_an_image_of_its_own(addon, place, plate, material, call):
    def image():
        return addon.nodes.thickness.wiring(material).node.image

    material.lamina.layers[0].name = 70 * "ä"  # longer than the names of Blender's properties
    choose(plate, call, "IMAGE")
    first = image()
    addon.editing.layer_list.add_layer(material)
    choose(plate, call, "IMAGE")
    second = image()
    assert second != first
    for index, own in ((1, first), (0, second), (1, first)):
        material.lamina.active_index = index
        choose(plate, call, "IMAGE")
        assert image() == own and first.users == second.users == 1


def test_the_painted_coverage_comes_back(addon, place, plate, material, call):
    addon.editing.layer_list.add_layer(material, "interface")
    choose(plate, call, "PAINTED")
    image = addon.nodes.thickness.wiring(material, "Coverage").node.image
    for name in ("EVEN", "DROPS"):
        choose(plate, call, name)
        choose(plate, call, "PAINTED")
        assert addon.nodes.thickness.wiring(material, "Coverage").node.image == image


def test_other_objects_with_the_material_are_named(place, plate, material, call):
    grid(material=material).name = "Table"
    bpy.context.view_layer.objects.active = plate
    job = place.start(bpy.context, material, "SETTLED")
    job.wait()
    said = job.finish()
    assert said.endswith("Table with this material: nothing has settled there yet, see Dust These Objects")


def test_a_mesh_that_cannot_hold_the_place_changes_nothing(addon, place, plate, material, call):
    while plate.data.uv_layers:
        plate.data.uv_layers.remove(plate.data.uv_layers[0])
    wiped = plate.data.attributes.new(addon.settling.wiping.ATTRIBUTE, "FLOAT", "POINT")
    with pytest.raises(RuntimeError, match="another kind of attribute named lamina_wiped"):
        choose(plate, call, "PAINTED")
    plate.data.attributes.remove(wiped)
    plate.data = bpy.data.meshes.new("Loose")
    plate.data.from_pydata([(0, 0, 0), (1, 0, 0)], [(0, 1)], [])
    plate.data.materials.append(material)
    with pytest.raises(RuntimeError, match="has no faces that could be unwrapped"):
        choose(plate, call, "IMAGE")
    layer = material.lamina.layers[0]
    assert not layer.varying and layer.tau == pytest.approx(0.3) and material.lamina.node_group is None
    material.lamina.active_index = 0
    addon.editing.layer_list.add_layer(material, "interface")
    with pytest.raises(RuntimeError, match="has no faces that could be unwrapped"):
        choose(plate, call, "PAINTED")
    assert not material.lamina.layers[0].varying and material.lamina.node_group is None


def test_edit_mode_at_the_end_of_a_job_changes_nothing(addon, place, plate, material, call):
    choose(plate, call, "PAINTED")
    choose(plate, call, "EVEN")
    own = material.node_tree.nodes.new("ShaderNodeValue")
    material.node_tree.links.new(own.outputs[0], socket(addon, material))
    for name, words in (("SETTLED", "leave Edit Mode"), ("PAINTED", "leave Edit Mode")):
        job = place.start(bpy.context, material, name)
        job.wait(60.0)
        addon.settling.dust_job.forget()
        bpy.ops.object.mode_set(mode="EDIT")
        with pytest.raises(addon.base.messages.RefusedError, match=words):
            job.finish()
        bpy.ops.object.mode_set(mode="OBJECT")
        assert addon.nodes.thickness.wiring(material).node == own and NAME not in plate.data.attributes


def test_a_hidden_object_is_not_painted(addon, place, plate, material, call):
    choose(plate, call, "IMAGE")
    plate.hide_viewport = True
    with bpy.context.temp_override(object=plate):
        with pytest.raises(RuntimeError, match="^Error: Plate is hidden in the viewport: show it to paint on it"):
            call(bpy.ops.lamina.dust_wipe, material)
        assert addon.nodes.detail_wiring.mask(material) is None
        assert call(bpy.ops.lamina.dust_wipe, material, paint=False) == {"FINISHED"}


def test_a_film_whose_image_was_deleted_gets_another(addon, place, plate, material, call):
    addon.editing.layer_list.add_layer(material, "interface")
    choose(plate, call, "PAINTED")
    bpy.data.images.remove(addon.nodes.thickness.wiring(material, "Coverage").node.image)
    assert not call(bpy.ops.lamina.film_paint.poll, material)
    choose(plate, call, "PAINTED")
    assert addon.nodes.thickness.wiring(material, "Coverage").node.image is not None
    assert call(bpy.ops.lamina.film_paint.poll, material)
