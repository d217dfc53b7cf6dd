# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets by picture: each preset has a picture in the extension, and a click on one applies it."""

from types import SimpleNamespace

import bpy
import pytest
from addon_helpers import Layout


def lines(addon, picker, material=None):
    layout = Layout()
    context = SimpleNamespace(window_manager=SimpleNamespace(lamina_picker=picker), material=material)
    addon.ui.preset_picker.draw(layout, context)
    return layout.lines


def test_each_preset_has_a_picture_and_each_picture_a_preset(addon, lamina):
    pictured = addon.ui.preset_picker.pictured()
    assert pictured == set(lamina.presets.names())
    for name in pictured:
        image = bpy.data.images.load(str(addon.ui.preset_picker.FOLDER / f"{name}.jpg"))
        assert tuple(image.size) == (112, 112) and image.has_data
        bpy.data.images.remove(image)


def test_the_picker_lists_all_presets_by_category(addon, lamina):
    picker = bpy.context.window_manager.lamina_picker
    categories = [item[0] for item in addon.ui.preset_picker._categories(picker, bpy.context)]
    found = []
    for category in categories:
        picker.category = category
        found += [item[0] for item in addon.ui.preset_picker._presets(picker, bpy.context)]
    assert sorted(found) == lamina.presets.names()


def test_a_search_finds_presets_of_all_categories(addon, lamina):
    picker = bpy.context.window_manager.lamina_picker
    picker.category, picker.search = "Metals", "DUSTY bron"
    assert [item[0] for item in addon.ui.preset_picker._presets(picker, None)] == ["dusty-bronze"]
    picker.search = "no such"
    assert lines(addon, picker)[-1] == "No preset has this name"
    picker.search = ""


def test_a_click_on_a_picture_applies_the_preset(addon, lamina, material):
    """That the click also bakes is a story in a window: without one, Blender executes operators in place of invoking
    them."""
    picker = bpy.context.window_manager.lamina_picker
    entry = addon.editing.presets.entry("dusty-bronze")
    picker.category = entry.category
    with bpy.context.temp_override(material=material):
        picker.preset = entry.id
    assert picker.preset == entry.id
    assert addon.editing.stack_io.to_stack(material).hash == entry.stack.hash


def test_a_click_while_a_bake_runs_changes_nothing(addon, lamina, material, monkeypatch):
    """The running bake would be of other layers, and a second one cannot start."""
    picker, before = bpy.context.window_manager.lamina_picker, addon.editing.stack_io.to_dict(material)
    monkeypatch.setattr(addon.baking.bake_job, "running", lambda: object())
    with bpy.context.temp_override(material=material):
        assert not bpy.ops.lamina.preset_apply.poll()
        picker.category = "Dust and weathering"
        picker.preset = "dusty-bronze"
        with pytest.raises(RuntimeError, match="A bake is running"):
            bpy.ops.lamina.bake("INVOKE_DEFAULT")
    assert addon.editing.stack_io.to_dict(material) == before


def test_a_click_that_is_refused_says_why(addon, lamina, material):
    """Metals have no layers to lie over another material."""
    picker, plain = bpy.context.window_manager.lamina_picker, bpy.data.materials.new("Plain")
    addon.nodes.node_tree.of(plain)
    addon.editing.over_material.add(plain)
    picker.category = "Metals"
    with bpy.context.temp_override(material=plain):
        picker.preset = "gold"
    assert "has no layers that could lie over this material" in addon.ui.preset_picker.refusal(plain)
    assert addon.ui.preset_picker.refusal(material) == ""
    picker.category = "Dust and weathering"
    with bpy.context.temp_override(material=plain):
        picker.preset = "dusty-bronze"
    assert addon.ui.preset_picker.refusal(plain) == ""


def test_the_artist_chooses_what_of_a_preset_is_used(addon, lamina, material):
    """Only its layers over the material, or all of it: also over a material without layers, and in the menu."""
    picker, plain = bpy.context.window_manager.lamina_picker, bpy.data.materials.new("Plain")
    addon.nodes.node_tree.of(plain)
    picker.search, picker.category = "", "Dust and weathering"
    assert "What" in lines(addon, picker, plain)
    with bpy.context.temp_override(material=plain):
        assert picker.over == "ALL", "a material without layers"
        picker.over = "OVER"
        picker.preset = "dusty-bronze"
        assert plain.lamina.base.kind == "principled" and picker.over == "OVER"
        assert [layer.name for layer in plain.lamina.layers] == ["dust"]
        picker.over = "ALL"
        picker.preset = "dusty-bronze"
        assert plain.lamina.base.kind == "conductor"
    with bpy.context.temp_override(material=material):
        assert picker.over == "ALL", "another material"
        picker.over, before = "OVER", addon.editing.stack_io.to_dict(material)["base"]
        picker.preset = "dusty-lacquer"
        assert addon.editing.stack_io.to_dict(material)["base"] == before
    layout = Layout()
    addon.ui.menus.LAMINA_MT_presets.draw(SimpleNamespace(layout=layout), SimpleNamespace(material=material))
    assert addon.ui.preset_picker.over(material) == "OVER" and "Gold, satin" in layout.lines


def test_layers_are_shown_after_a_click(addon, lamina, material):
    addon.editing.presets.apply(material, "gold")
    material.lamina.quality = "preview"
    with bpy.context.temp_override(material=material):
        assert addon.operators.common.show_layers(None, bpy.context) == {"FINISHED"}
    assert addon.baking.bake_job.state(material) == "fresh" and addon.nodes.node_group.is_connected(material)


def test_a_script_that_applies_a_preset_bakes_nothing(addon, lamina, material, call):
    assert call(bpy.ops.lamina.preset_apply, material, preset="dusty-bronze") == {"FINISHED"}
    assert addon.baking.bake_job.state(material) == "none"


def test_overlays_come_first(addon, lamina):
    picker = bpy.context.window_manager.lamina_picker
    assert addon.ui.preset_picker._categories(picker, None)[0][0] == addon.editing.presets.OVERLAYS


def test_without_the_library_the_picker_says_so(addon, monkeypatch):
    def gone():
        raise addon.base.native.NativeMissingError("no wheel")

    picker = addon.ui.preset_picker
    monkeypatch.setattr(picker.presets, "by_category", gone)
    monkeypatch.setattr(picker, "_items", {})
    settings = SimpleNamespace(category="NONE", search="")
    assert picker._categories(settings, None) == picker._NONE == picker._presets(settings, None)
