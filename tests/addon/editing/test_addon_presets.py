# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets: the library, the user's own, and metals by name."""

import json
import sys
from types import ModuleType, SimpleNamespace

import bpy
import numpy as np
import pytest
from addon_helpers import Layout

VARNISH = {
    "schema": 1,
    "layers": [{"kind": "interface", "name": "varnish", "ior": 1.5, "alpha": 0.01}],
    "base": {"kind": "lambert", "reflectance": [0.5, 0.3, 0.1]},
}


@pytest.fixture
def library(lamina, monkeypatch):
    """A library of one preset in place of the real one."""
    module = ModuleType("lamina.presets")
    entry = SimpleNamespace(
        id="varnished-wood", name="Varnished Wood", category="wood", source="Measured by hand",
        stack=lamina.Stack.from_json(VARNISH),
    )  # fmt: skip
    module.entries = lambda: [entry]
    monkeypatch.setitem(sys.modules, "lamina.presets", module)


@pytest.fixture
def folder(addon, monkeypatch, tmp_path):
    monkeypatch.setattr(addon.editing.presets, "user_folder", lambda create=False: tmp_path)
    return tmp_path


def refused(operator, material, call, **properties):
    """The one sentence with which an operator refuses."""
    with pytest.raises(RuntimeError) as caught:
        call(operator, material, **properties)
    text = str(caught.value).strip().removeprefix("Error: ")
    assert "Traceback" not in text and "\n" not in text
    return text


def test_applying_by_operator_and_by_function(addon, material, library, call):
    other = bpy.data.materials.new("Plain")
    addon.editing.presets.apply(other, "varnished-wood")
    assert call(bpy.ops.lamina.preset_apply, material, preset="varnished-wood") == {"FINISHED"}
    assert addon.editing.stack_io.to_dict(material) == addon.editing.stack_io.to_dict(other) == VARNISH
    assert other.lamina.enabled and list(addon.editing.presets.by_category()) == ["wood"]


def test_applying_can_be_undone(addon, material, library, call):
    material.use_fake_user = True
    before = addon.editing.stack_io.to_dict(material)
    bpy.ops.ed.undo_push(message="before")
    with bpy.context.temp_override(material=material):
        bpy.ops.lamina.preset_apply("EXEC_DEFAULT", True, preset="varnished-wood")
    assert addon.editing.stack_io.to_dict(material) == VARNISH
    bpy.ops.ed.undo()
    assert addon.editing.stack_io.to_dict(bpy.data.materials["Bronze"]) == before


def test_the_tooltip_names_the_source(addon, library):
    operator = addon.operators.presets.LAMINA_OT_preset_apply
    text = operator.description(None, SimpleNamespace(preset="varnished-wood", user=False, over="AUTO"))
    assert "Measured by hand" in text
    gone = SimpleNamespace(preset="gone", user=False, over="AUTO")
    assert operator.description(None, gone) == operator.bl_description


def test_an_unknown_preset_is_one_sentence(addon, material, library, call):
    before = addon.editing.stack_io.to_dict(material)
    assert "no such preset" in refused(bpy.ops.lamina.preset_apply, material, call, preset="gone")
    assert addon.editing.stack_io.to_dict(material) == before


def test_the_panel_holds_every_preset_of_the_library(addon, material, lamina):
    def as_kept(text):
        """The number as a float32, as the panel stores it."""
        return addon.base.decimals.shortest(float(np.float32(text)))

    def rounded(stack):
        text = json.dumps(stack.to_json())
        return lamina.Stack.from_json(json.loads(text, parse_float=as_kept)).hash

    for entry in addon.base.native.part("presets").entries():
        if entry.stack.is_oriented and bpy.app.version < (5, 0):
            with pytest.raises(ValueError, match=r"need Blender 5\.0"):
                addon.editing.presets.apply(material, entry.id)
            continue
        addon.editing.presets.apply(material, entry.id)
        if entry.stack.is_oriented:
            assert material.lamina.tangent == ("Z" if entry.id == "turned-brass" else "UV")
        stack = addon.base.native.part("presets").load(entry.id)
        kept = addon.editing.stack_io.to_stack(material)
        if entry.category == addon.editing.presets.OVERLAYS:
            stack = lamina.Stack(stack.layers, kept.base)
        assert rounded(kept) == rounded(stack), entry.id


def test_save_list_apply_and_delete(addon, material, lamina, folder, call):
    addon.editing.stack_io.assign(material, VARNISH)
    assert addon.editing.presets.user_names() == []
    assert addon.editing.presets.save_user(material, "  by   function ") == "by function"
    assert call(bpy.ops.lamina.preset_save, material, name="By Operator") == {"FINISHED"}
    assert addon.editing.presets.user_names() == ["by function", "By Operator"]
    assert (folder / "by function.json").read_text() == (folder / "By Operator.json").read_text()
    plain = [bpy.data.materials.new("Plain"), bpy.data.materials.new("Plain")]
    addon.editing.presets.apply_user(plain[0], "by function")
    assert call(bpy.ops.lamina.preset_apply, plain[1], preset="By Operator", user=True) == {"FINISHED"}
    assert [addon.editing.stack_io.to_dict(one) for one in plain] == [VARNISH, VARNISH]
    addon.editing.presets.delete_user("by function")
    assert bpy.ops.lamina.preset_delete(name="By Operator") == {"FINISHED"}
    assert addon.editing.presets.user_names() == [] and not list(folder.iterdir())


def test_a_taken_name_is_not_replaced_unasked(addon, material, lamina, folder, call):
    addon.editing.presets.save_user(material, "Dusty")
    before = (folder / "Dusty.json").read_text()
    addon.editing.stack_io.assign(material, VARNISH)
    assert "tick Replace" in refused(bpy.ops.lamina.preset_save, material, call, name="dusty")
    assert (folder / "Dusty.json").read_text() == before
    assert addon.editing.presets.save_user(material, "dusty", replace=True) == "Dusty"
    assert addon.editing.presets.user_names() == ["Dusty"] and (folder / "Dusty.json").read_text() != before


BAD_NAMES = ["", "   ", "a/b", "..", ".hidden", "a\\b", "what?", "tab\x07", "stop.", "con", "NUL.txt", "x" * 61]


@pytest.mark.parametrize("name", BAD_NAMES)
def test_bad_names_are_one_sentence(addon, material, lamina, folder, name):
    with pytest.raises(addon.base.messages.RefusedError) as caught:
        addon.editing.presets.save_user(material, name)
    assert str(caught.value).startswith("name") and "\n" not in str(caught.value)
    assert not list(folder.iterdir())


def test_an_invalid_stack_is_not_saved(addon, material, lamina, folder, call):
    material.lamina.layers.clear()
    material.lamina.base.kind = "none"
    assert "must hold" in refused(bpy.ops.lamina.preset_save, material, call, name="Nothing")
    assert not list(folder.iterdir())


def test_an_unreadable_preset_hides_no_other(addon, material, lamina, folder, call):
    addon.editing.presets.save_user(material, "Good")
    (folder / "Broken.json").write_text('{"schema": 1, "lay')
    (folder / "Newer.json").write_text('{"schema": 99, "layers": []}')
    (folder / "Folder.json").mkdir()
    (folder / "notes.txt").write_text("not a preset")
    assert addon.editing.presets.user_names() == ["Broken", "Good", "Newer"]
    before = addon.editing.stack_io.to_dict(material)
    for name in ("Broken", "Newer"):
        assert name in refused(bpy.ops.lamina.preset_apply, material, call, preset=name, user=True)
    assert addon.editing.stack_io.to_dict(material) == before
    assert call(bpy.ops.lamina.preset_apply, material, preset="Good", user=True) == {"FINISHED"}


@pytest.mark.parametrize("name", ["gone", "../../secret", "/etc/passwd"])
def test_only_listed_presets_are_read_or_deleted(addon, material, lamina, folder, call, name):
    assert "no preset of this name" in refused(bpy.ops.lamina.preset_apply, material, call, preset=name, user=True)
    with pytest.raises(RuntimeError, match="no preset of this name"):
        bpy.ops.lamina.preset_delete(name=name)


def test_a_folder_that_cannot_be_read_is_empty(addon, monkeypatch, tmp_path):
    monkeypatch.setattr(addon.editing.presets, "user_folder", lambda create=False: tmp_path / "nowhere")
    assert addon.editing.presets.user_names() == []


def test_the_folder_is_the_extensions_own(addon):
    folder = addon.editing.presets.user_folder()
    assert folder.name == "presets" and ".user" in folder.parts and not folder.exists()


@pytest.fixture
def metals(lamina, monkeypatch):
    """Two metals in place of the real ones."""
    real, module = lamina.metals, ModuleType("lamina.metals")
    metals = {
        "gold": lamina.Conductor(facing=(1.0, 0.75, 0.3), grazing=(1.0, 0.9, 0.6)),
        "tin": lamina.Conductor(facing=(0.8, 0.75, 0.7), grazing=(0.8, 0.8, 0.8)),
    }
    module.names = lambda: list(metals)
    module.conductor = metals.__getitem__
    module.indices_of = real.indices_of
    module.source = lambda name: f"{name} by hand"
    monkeypatch.setitem(sys.modules, "lamina.metals", module)
    return metals


def test_a_metal_by_name(addon, material, metals, call):
    other = bpy.data.materials.new("Other")
    addon.editing.layer_list.add_stack(other)
    for name in metals:
        addon.editing.metals.fill(other.lamina.base, name)
        assert call(bpy.ops.lamina.metal, material, metal=name) == {"FINISHED"}
        assert addon.editing.stack_io.to_dict(material)["base"] == addon.editing.stack_io.to_dict(other)["base"]
        assert addon.editing.metals.name_of(material.lamina.base) == name
    assert tuple(material.lamina.base.facing) == pytest.approx((0.8, 0.75, 0.7))
    material.lamina.base.facing[1] += 0.1
    assert addon.editing.metals.name_of(material.lamina.base) == ""
    material.lamina.base.metal_form = "indices"
    assert addon.editing.metals.name_of(material.lamina.base) == "tin"
    assert "must be one of gold, tin" in refused(bpy.ops.lamina.metal, material, call, metal="lead")


def test_every_metal_of_the_library(addon, material, lamina):
    assert addon.editing.metals.names()
    for name in addon.editing.metals.names():
        addon.editing.metals.fill(material.lamina.base, name)
        assert addon.editing.metals.name_of(material.lamina.base) == name
        colours = lamina.metals.conductor(name)
        assert addon.editing.stack_io.to_stack(material).base.facing == colours.facing
        assert addon.editing.stack_io.to_stack(material).base.grazing == colours.grazing
        material.lamina.base.metal_form = "indices"
        assert addon.editing.metals.name_of(material.lamina.base) == name
        shown = lamina.metals.colours_of(addon.editing.stack_io.to_stack(material).base)
        assert shown == (pytest.approx(colours.facing, abs=1e-5), pytest.approx(colours.grazing, abs=1e-5))


def test_the_first_metal_is_the_librarys_gold(addon, material, lamina):
    base = material.lamina.base
    base.kind = "conductor"
    for form in ("colours", "indices"):
        assert base.metal_form == form and addon.editing.metals.name_of(base) == "gold"
        base.metal_form = "indices"
    base.k[0] = 5.0
    base.kind = "black"
    base.kind = "conductor"
    assert base.k[0] == 5.0 and base.metal_form == "indices"


def test_a_metal_that_an_older_file_never_set_keeps_its_numbers(addon, material, lamina):
    """Properties that were never touched are not in a file: the index of gold in its first form."""
    base = material.lamina.base
    base.kind = "conductor"
    for name in ("metal_form", "eta", "k", "facing", "grazing"):
        base.property_unset(name)
    assert addon.editing.stack_io.to_dict(material)["base"] == {
        "kind": "conductor", "eta": [0.2141, 0.4547, 1.332], "k": [3.251, 2.406, 1.869], "alpha": 0.0,
    }  # fmt: skip


def test_a_library_whose_files_are_gone_is_one_sentence(addon, lamina, material, call, monkeypatch, tmp_path):
    """Another Blender with the same user folder removes the files of the wheel."""
    library = addon.base.native.part("material.presets")
    library._texts.cache_clear()
    library._load.cache_clear()
    monkeypatch.setattr(library, "files", lambda package: tmp_path / "gone")
    try:
        layout = Layout()
        addon.ui.menus.LAMINA_MT_presets.draw(SimpleNamespace(layout=layout), None)
        assert addon.base.native.GONE in layout.lines
        assert addon.base.native.GONE in refused(bpy.ops.lamina.preset_apply, material, call, preset="gold")
        chosen = SimpleNamespace(preset="gold", user=False, over="AUTO")
        assert addon.operators.presets.LAMINA_OT_preset_apply.description(None, chosen) == addon.base.native.GONE
    finally:
        library._texts.cache_clear()
        library._load.cache_clear()


def test_a_part_of_the_package_that_is_gone(addon, lamina, monkeypatch):
    monkeypatch.setattr(lamina, "__file__", "/nowhere/lamina/__init__.py")
    with pytest.raises(addon.base.native.NativeMissingError, match="another Blender has removed or replaced them"):
        addon.base.native.part("not_there")


def test_presets_of_python_and_of_the_panel_are_the_same(addon, material, lamina, monkeypatch, tmp_path):
    monkeypatch.setenv("LAMINA_PRESETS", str(tmp_path / "shared"))
    lamina.presets.save(lamina.presets.load("soot-on-brick"), "Soot of Python")
    assert addon.editing.presets.user_names() == ["Soot of Python"]
    addon.editing.presets.apply_user(material, "Soot of Python")
    assert addon.editing.presets.save_user(material, "Soot of the panel") == "Soot of the panel"
    assert lamina.presets.user_names() == ["Soot of Python", "Soot of the panel"]
    assert lamina.solve("Soot of the panel", "preview").stack.hash == lamina.presets.load("soot-on-brick").hash
