# SPDX-License-Identifier: GPL-3.0-or-later
"""A measured material as a base: read from a file, shown, baked, undone, and kept by the .blend file."""

import warnings

import bpy
import pytest
from addon_helpers import drawn_base


@pytest.fixture
def paint(lamina, tmp_path):
    """A .bsdf file of a rough metal below a layer."""
    stack = lamina.Stack([lamina.Medium(albedo=[0.2, 0.4, 0.8], tau=0.4)], lamina.Conductor(0.4, 2.5, alpha=0.3))
    lamina.rgl.save_bsdf(stack, tmp_path / "blue-paint.bsdf", size=32, angles=12)
    return tmp_path / "blue-paint.bsdf"


def test_the_operator_reads_as_the_function_does(addon, lamina, material, call, paint):
    assert call(bpy.ops.lamina.measured_base, material, filepath=str(paint)) == {"FINISHED"}
    other = bpy.data.materials.new("Other")
    addon.editing.layer_list.add_stack(other)
    assert addon.editing.measured.read(other, paint) == ""
    data = addon.editing.stack_io.to_dict(material)["base"]
    assert data == addon.editing.stack_io.to_dict(other)["base"]
    assert addon.editing.stack_io.to_stack(material).base == lamina.measurements.load_base(paint)
    assert data["name"] == "blue-paint" and "blue-paint" in " ".join(drawn_base(addon, material.lamina.base))


def test_a_missing_file_is_a_sentence_and_changes_nothing(addon, material, call, tmp_path):
    before = addon.editing.stack_io.to_dict(material)
    for name, words in (("nowhere.bsdf", "No such file"), ("x.txt", "unknown format")):
        with pytest.raises(RuntimeError, match=words):
            call(bpy.ops.lamina.measured_base, material, filepath=str(tmp_path / name))
    (tmp_path / "bad.binary").write_bytes(b"bad")
    with pytest.raises(RuntimeError, match=r"must be a \.binary file of MERL"):
        call(bpy.ops.lamina.measured_base, material, filepath=str(tmp_path / "bad.binary"))
    assert addon.editing.stack_io.to_dict(material) == before


def test_a_base_without_a_file_says_what_to_do(addon, lamina, material):
    material.lamina.base.kind = "measured"
    with pytest.raises(lamina.StackError) as error:
        addon.editing.stack_io.to_stack(material)
    sentence = addon.base.messages.sentence(error.value, material)
    assert sentence.startswith("Base, measured file is missing: must be read from a .binary file of MERL")
    assert "Choose..." in " ".join(drawn_base(addon, material.lamina.base))


def test_data_that_gain_light_are_a_warning(addon, lamina, material, monkeypatch, paint):
    load = lamina.measurements.load_base

    def warned(path):
        warnings.warn("scaled", stacklevel=2)
        return load(path)

    monkeypatch.setattr(lamina.measurements, "load_base", warned)
    assert addon.editing.measured.read(material, paint) == "scaled"


def test_the_blend_file_keeps_the_table_and_its_bake(addon, lamina, material, call, paint, tmp_path):
    addon.editing.measured.read(material, paint)
    paint.unlink()
    assert call(bpy.ops.lamina.bake, material) == {"FINISHED"}
    before = addon.editing.stack_io.to_stack(material)
    assert material.lamina.node_group is not None
    material.use_fake_user = True
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "kept.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "kept.blend"))
    again = bpy.data.materials["Bronze"]
    assert addon.editing.stack_io.to_stack(again) == before and again.lamina.node_group is not None


def test_another_base_and_back(addon, lamina, material, paint):
    addon.editing.measured.read(material, paint)
    table = material.lamina.base.table
    material.lamina.base.kind = "lambert"
    assert "table" not in addon.editing.stack_io.to_dict(material)["base"]
    material.lamina.base.kind = "measured"
    assert material.lamina.base.table == table
