# SPDX-License-Identifier: GPL-3.0-or-later
"""The coverage of a varying interface: the panel's choice, both tables in one image, the input and its source."""

import json

import bpy
import numpy as np
import pytest
from addon_helpers import drawn, image_of, look_until_rest, pixels
from rendered_plane import add_plane, render


@pytest.fixture
def wet(addon, lamina, material):
    """A baked material with dust below a film of water that covers it or not."""
    film = addon.editing.layer_list.add_layer(material, "interface")
    film.ior, film.varying = 1.33, True
    addon.baking.bake_job.bake_material(material)
    return material


def group_input(material, addon):
    return addon.nodes.node_group.group_nodes(material)[0].inputs["Coverage"]


def test_one_medium_and_one_interface_vary(addon, material):
    layers, add = material.lamina.layers, addon.editing.layer_list.add_layer
    for kind in ("medium", "interface", "interface", "medium"):
        add(material, kind)
    for layer in layers:
        layer.varying = True
    varying = [layer for layer in layers if layer.varying]
    assert sorted(layer.kind for layer in varying) == ["interface", "medium"]
    data = addon.editing.stack_io.to_dict(material)
    assert sum(layer.get("varying", False) for layer in data["layers"]) == 2
    other = bpy.data.materials.new("Other")
    addon.editing.stack_io.assign(other, data)
    assert addon.editing.stack_io.to_dict(other) == data
    interface = next(layer for layer in varying if layer.kind == "interface")
    assert "Varying" in drawn(addon.ui.details.draw_layer, interface)
    interface.kind = "medium"
    assert not interface.varying and [layer.varying for layer in layers].count(True) == 1


def test_both_tables_lie_in_one_image(addon, lamina, wet):
    lut = addon.baking.bake_job.bake_material(wet)
    image = image_of(wet.lamina.node_group)
    first, second = addon.nodes.lut_image.tables(lut, addon.nodes.node_group.few_closures)
    texels, height = pixels(image), image.size[1]
    for table, own in ((first, lut), (second, lut.uncovered)):
        assert table.height == height
        assert np.array_equal(texels[table.first:][:len(own.image())], own.image())
        strips, rows = table.eevee.texels, own.weights.shape[2]
        start = table.first + addon.nodes.lut_image.eevee_strip(own, 0) * rows
        assert np.array_equal(texels[start:start + rows], strips[0, 0])


def test_the_input_is_there_while_an_interface_varies(addon, wet):
    socket = addon.nodes.group_sockets.named(wet.lamina.node_group, "INPUT")["Coverage"]
    assert (socket.subtype, socket.min_value, socket.max_value, socket.default_value) == ("FACTOR", 0.0, 1.0, 1.0)
    assert group_input(wet, addon).default_value == 1.0
    group_input(wet, addon).default_value = 0.25
    addon.baking.bake_job.bake_material(wet)
    assert group_input(wet, addon).default_value == 0.25
    wet.lamina.layers[0].varying = False
    addon.baking.bake_job.bake_material(wet)
    assert "Coverage" not in addon.nodes.node_group.group_nodes(wet)[0].inputs
    assert len(bpy.data.images) == 1


def test_updates_of_the_film_keep_the_nodes(addon, wet, monkeypatch):
    update, group = addon.baking.update, wet.lamina.node_group
    monkeypatch.setattr(update, "REST", 0.0)
    update.leave(wet)
    nodes, before = [node.as_pointer() for node in group.nodes], pixels(image_of(group))
    wet.lamina.layers[0].ior = 1.4
    update.poll()
    update.running().wait()
    update.poll()
    assert [node.as_pointer() for node in group.nodes] == nodes
    assert not np.array_equal(pixels(image_of(group)), before)
    look_until_rest(update)
    assert addon.baking.bake_job.state(wet) == "fresh"
    wet.lamina.layers[0].varying = False
    look_until_rest(update)
    assert addon.baking.bake_job.state(wet) == "fresh" and [node.as_pointer() for node in group.nodes] != nodes


SOURCES = {"value": ("", ()), "attribute": ("lamina_dust", ("coverage attribute",)),
           "image": ("Bronze coverage", ("coverage image", "coverage uv"))}  # fmt: skip


@pytest.mark.parametrize(("source", "name", "marks"), [(key, *value) for key, value in SOURCES.items()], ids=SOURCES)
def test_each_source_is_wired_and_shown(addon, wet, source, name, marks):
    addon.nodes.thickness.wire_thickness(wet, source, to="Coverage")
    now = addon.nodes.thickness.wiring(wet, "Coverage")
    assert (now.source, now.name) == (source, name)
    assert {node.get("lamina_thickness") for node in wet.node_tree.nodes} - {None} == set(marks)
    assert addon.nodes.thickness.wiring(wet).source == "none"  # of the thickness
    wet.lamina.layers[0].varying = False
    addon.baking.bake_job.bake_material(wet)
    wet.lamina.layers[0].varying = True
    addon.baking.bake_job.bake_material(wet)
    assert addon.nodes.thickness.wiring(wet, "Coverage").source == source, "linked again"
    addon.nodes.thickness.wire_thickness(wet, "value", to="Coverage")
    assert not any(node.get("lamina_thickness") for node in wet.node_tree.nodes)


def test_thickness_and_coverage_have_sources_of_their_own(addon, wet):
    thickness = addon.nodes.thickness
    wet.lamina.layers[1].varying = True
    addon.baking.bake_job.bake_material(wet)
    thickness.wire_thickness(wet, "attribute", "dust")
    thickness.wire_thickness(wet, "attribute", "rain", to="Coverage")
    assert (thickness.wiring(wet).name, thickness.wiring(wet, "Coverage").name) == ("dust", "rain")
    thickness.wire_thickness(wet, "value")
    assert (thickness.wiring(wet).source, thickness.wiring(wet, "Coverage").name) == ("value", "rain")


def test_a_material_without_coverage_refuses_a_source(addon, lamina, material):
    addon.baking.bake_job.bake_material(material)
    with pytest.raises(addon.base.messages.RefusedError, match="no coverage input: choose Painted"):
        addon.nodes.thickness.wire_thickness(material, "attribute", to="Coverage")


def test_the_result_tells_the_error_without_the_film(addon, wet):
    report = json.loads(wet.lamina.result.report_json)
    assert set(report["uncovered"]) == {"fit_error", "worst_slice"}
    assert "Without the Film" in dict(addon.ui.numbers.result_lines(wet.lamina.result))


def test_an_attribute_says_where_the_film_is(addon, wet, tmp_path):
    add_plane(wet)
    seen = {}
    for coverage in (0.0, 1.0):
        group_input(wet, addon).default_value = coverage
        seen[coverage] = render(tmp_path / f"{coverage}.exr")
    assert np.abs(seen[0.0] - seen[1.0]).max() > 0.01
    addon.nodes.thickness.wire_thickness(wet, "attribute", "rain", to="Coverage")
    assert np.array_equal(render(tmp_path / "dry.exr"), seen[0.0]), "a mesh without the attribute is dry"
    mesh = bpy.data.objects["Patch"].data
    attribute = mesh.attributes.new("rain", "FLOAT", "POINT")
    attribute.data.foreach_set("value", [1.0] * 4)
    assert render(tmp_path / "wet.exr") == pytest.approx(seen[1.0], rel=1e-5)
