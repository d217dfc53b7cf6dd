# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets by picture: each preset has a picture in the extension, and the button applies the chosen one."""

from types import SimpleNamespace

import bpy
from addon_helpers import Layout


def lines(addon, picker):
    layout = Layout()
    context = SimpleNamespace(window_manager=SimpleNamespace(lamina_picker=picker))
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


def test_the_button_names_and_applies_the_chosen_preset(addon, lamina, material, call):
    picker = bpy.context.window_manager.lamina_picker
    entry = addon.editing.presets.entry("dusty-bronze")
    picker.category = entry.category
    picker.preset = entry.id
    assert lines(addon, picker)[-1] == f"Use {entry.name}"
    assert call(bpy.ops.lamina.preset_apply, material, preset=picker.preset) == {"FINISHED"}
    assert addon.editing.stack_io.to_stack(material).hash == entry.stack.hash


def test_without_the_library_the_picker_says_so(addon, monkeypatch):
    def gone():
        raise addon.base.native.NativeMissingError("no wheel")

    picker = addon.ui.preset_picker
    monkeypatch.setattr(picker.presets, "by_category", gone)
    monkeypatch.setattr(picker, "_items", {})
    settings = SimpleNamespace(category="NONE")
    assert picker._categories(settings, None) == picker._NONE == picker._presets(settings, None)
