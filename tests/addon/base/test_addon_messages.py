# SPDX-License-Identifier: GPL-3.0-or-later
"""Sentences, migration, and the panel's text."""

from pathlib import Path

import bpy
import pytest

SENTENCES = {
    "layers[0].phase.g = 1.2: must lie in [-0.964, 0.964]":
        "Layer 1 “Dust”, anisotropy = 1.2: must lie in [-0.964, 0.964]",
    "layers[0].albedo[1] = 2: must lie in [0, 1]": "Layer 1 “Dust”, albedo (green) = 2: must lie in [0, 1]",
    "layers[7].tau = -1: must not be negative": "Layer 8, optical thickness = -1: must not be negative",
    "layers[0]: an infinite layer must be the last": "Layer 1 “Dust”: an infinite layer must be the last",
    "base.reflectance[2] = 3: must lie in [0, 1]": "Base, reflectance (blue) = 3: must lie in [0, 1]",
    "layers[0].phase.parts[1].phase.g = 2: must lie in [-0.964, 0.964]": (
        "Layer 1 “Dust”, phase function parts[1].phase.g = 2: must lie in [-0.964, 0.964]"
    ),
    "layers[0].phase.parts have shares that sum to 2": (
        "Layer 1 “Dust”, phase function parts have shares that sum to 2"
    ),
    "layers[0].ior[2] = 9: must lie in [1, 4]": "Layer 1 “Dust”, IOR (blue) = 9: must lie in [1, 4]",
    "base.eta[0] = 0: must lie in [0.001, 100]": "Base, index n (red) = 0: must lie in [0.001, 100]",
    "schema = 9: this version reads up to 1": "schema = 9: this version reads up to 1",
    "baseline: odd": "baseline: odd",
    "the stack cannot be resolved with 160 nodes per hemisphere: azimuth error 0.04 (allowed 0.01)": (
        "These layers cannot be solved precisely enough: rougher surfaces help (azimuth error 0.04 (allowed 0.01))"
    ),
}


@pytest.mark.parametrize(("text", "expected"), SENTENCES.items())
def test_layers_are_named_as_in_the_panel(addon, material, text, expected):
    assert addon.base.messages.in_panel_words(text, material) == expected


def test_what_goes_wrong_in_the_stack_is_told_in_the_panel(addon, lamina, material):
    addon.editing.layer_list.add_layer(material)
    material.lamina.layers[0].infinite = True
    try:
        lamina.Stack.from_json(addon.editing.stack_io.to_dict(material))
    except lamina.StackError as error:
        text = addon.base.messages.sentence(error, material)
        assert text.startswith("Layer ") and "\n" not in text
        assert addon.ui.state_line.stack_error(material) == text
    else:
        assert addon.ui.state_line.stack_error(material) == ""


def test_wrapped(addon):
    lines = addon.base.messages.wrapped("one two three four", 9)
    assert lines == ["one two", "three", "four"]
    assert addon.base.messages.wrapped("", 10) == []
    assert addon.base.messages.wrapped("unbreakable", 3) == ["unbreakable"]


def test_old_files_are_brought_up_to_date_step_by_step(addon, material):
    done = []
    material.lamina.schema = 1
    steps = {1: lambda one: done.append((1, one.name)), 2: lambda one: done.append((2, one.name))}
    assert addon.properties.migration.migrate(material, steps, schema=3)
    assert done == [(1, "Bronze"), (2, "Bronze")] and material.lamina.schema == 3
    assert not addon.properties.migration.migrate(material, steps, schema=3)


# The properties as written by an earlier version.
SCHEMA_1 = {
    "Dusty": {
        "schema": 1,
        "layers": [
            {
                "kind": "medium", "name": "Layer.001", "sigma_s": [0.7, 1.22, 1.9],
                "sigma_a": [0.0014, 0.0025, 0.0142], "thickness": 0.25, "phase": {"kind": "rayleigh"},
                "varying": False,
            },
            {
                "kind": "medium", "name": "Dust", "albedo": [0.9, 0.8, 0.7], "tau": [0.1, 0.2, 0.3],
                "phase": {"kind": "hg", "g": 0.75}, "varying": True,
            },
        ],
        "base": {"kind": "half-space", "albedo": [0.3, 0.6, 0.9], "phase": {"kind": "isotropic"}},
    },
    "Sheet": {
        "schema": 1,
        "layers": [
            {
                "kind": "medium", "name": "Dust", "albedo": 0.8, "tau": 1.0, "phase": {"kind": "isotropic"},
                "varying": False,
            },
        ],
        "base": None,
    },
    "Untouched": {
        "schema": 1,
        "layers": [
            {
                "kind": "medium", "name": "Dust", "albedo": 0.8, "tau": 1.0, "phase": {"kind": "hg", "g": 0.6},
                "varying": False,
            },
        ],
        "base": {"kind": "lambert", "reflectance": 0.8},
    },
}  # fmt: skip


def test_a_file_of_schema_1_keeps_its_layers(addon):
    library = Path(__file__).parents[1] / "files" / "schema_1.blend"
    with bpy.data.libraries.load(str(library)) as (_source, target):
        target.materials = list(SCHEMA_1)
    assert [bpy.data.materials[name].lamina.schema for name in SCHEMA_1] == [1, 1, 1]
    addon.properties.migration.migrate_all()
    for name, expected in SCHEMA_1.items():
        material = bpy.data.materials[name]
        assert material.lamina.schema == addon.properties.material_properties.SCHEMA
        assert addon.editing.stack_io.to_dict(material) == expected


def test_files_from_the_future_are_left_alone(addon, material, call):
    material.lamina.schema = addon.properties.material_properties.SCHEMA + 1
    assert not addon.properties.migration.migrate(material)
    with pytest.raises(RuntimeError, match="newer version"):
        call(bpy.ops.lamina.layer_add, material)


def test_materials_without_layers_are_not_touched(addon):
    plain = bpy.data.materials.new("Plain")
    addon.properties.migration.migrate_all()
    assert not plain.lamina.enabled and plain.lamina.schema == 0


def test_register_twice_leaves_nothing_behind(addon):
    addon.unregister()
    assert not hasattr(bpy.types.Material, "lamina")
    for handlers in (bpy.app.handlers.load_post, bpy.app.handlers.load_pre):
        assert not [one for one in handlers if "lamina" in one.__module__]
    assert not [name for name in dir(bpy.types) if name.startswith("LAMINA_")]
    addon.register()
    assert hasattr(bpy.types.Material, "lamina")
