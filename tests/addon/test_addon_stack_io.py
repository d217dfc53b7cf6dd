# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties <-> stack JSON."""

import json

import bpy
import pytest

HG = {"kind": "hg", "g": 0.75}


def medium(name, phase, varying=False, **numbers):
    return {"kind": "medium", "name": name, **numbers, "phase": phase, "varying": varying}


def stack(layers, base):
    return {"schema": 1, "layers": layers, "base": base}


MILK = {"sigma_s": [0.7, 1.22, 1.9], "sigma_a": [0.0014, 0.0025, 0.0142], "thickness": 0.25}
STACKS = {
    "optical": stack(
        [
            medium("dust", HG, albedo=[0.9, 0.8, 0.7], tau=0.3, varying=True),
            medium("paint", {"kind": "isotropic"}, albedo=0.999, tau=2.0),
        ],
        {"kind": "lambert", "reflectance": [0.5, 0.3, 0.1]},
    ),
    "infinite": stack([medium("snow", {"kind": "rayleigh"}, albedo=1.0, tau="inf")], None),
    "coefficients": stack([medium("milk", {"kind": "hg", "g": -0.35}, **MILK)], {"kind": "black"}),
    "tau per channel": stack(
        [medium("haze", HG, albedo=0.5, tau=[0.1, 0.2, 1e6])],
        {"kind": "half-space", "albedo": [0.3, 0.6, 0.9], "phase": {"kind": "hg", "g": 0.1}},
    ),
}


@pytest.mark.parametrize("data", STACKS.values(), ids=STACKS)
def test_round_trip_is_exact(addon, material, data):
    addon.stack_io.assign(material, data)
    assert addon.stack_io.to_dict(material) == data


@pytest.mark.parametrize("data", STACKS.values(), ids=STACKS)
def test_the_panel_hashes_like_python(addon, material, lamina, data):
    addon.stack_io.assign(material, data)
    assert addon.stack_io.to_stack(material).hash == lamina.Stack.from_json(data).hash


@pytest.mark.parametrize("data", STACKS.values(), ids=STACKS)
def test_files(addon, material, lamina, tmp_path, data):
    path = tmp_path / "stack.json"
    path.write_text(json.dumps(data))
    addon.stack_io.import_file(material, str(path))
    other = tmp_path / "other.json"
    addon.stack_io.export_file(material, str(other))
    assert lamina.Stack.load(str(other)).hash == lamina.Stack.load(str(path)).hash


def test_operators_do_what_the_functions_do(addon, material, lamina, call, tmp_path):
    path, exported = tmp_path / "in.json", tmp_path / "out.json"
    path.write_text(json.dumps(STACKS["optical"]))
    assert call(bpy.ops.lamina.stack_import, material, filepath=str(path)) == {"FINISHED"}
    assert addon.stack_io.to_dict(material) == STACKS["optical"]
    assert call(bpy.ops.lamina.stack_export, material, filepath=str(exported)) == {"FINISHED"}
    assert lamina.Stack.load(str(exported)).hash == lamina.Stack.load(str(path)).hash


def test_importing_gives_a_plain_material_a_stack(addon, lamina, tmp_path):
    plain = bpy.data.materials.new("Plain")
    path = tmp_path / "stack.json"
    path.write_text(json.dumps(STACKS["infinite"]))
    addon.stack_io.import_file(plain, str(path))
    assert plain.lamina.enabled and plain.lamina.schema == addon.properties.SCHEMA


def _changed(**changes):
    data = json.loads(json.dumps(STACKS["optical"]))
    data["layers"][1].update(changes)
    return data


REFUSED = {
    "two channels": (_changed(albedo=[0.5, 0.6]), "layers[1].albedo has 2 channels"),
    "five channels": (_changed(tau=[1, 2, 3, 4, 5]), "layers[1].tau has 5 channels"),
    "g beyond the slider": (_changed(phase={"kind": "hg", "g": 0.995}), "layers[1].phase.g = 0.995"),
    "g per channel": (_changed(phase={"kind": "hg", "g": [0.1, 0.2, 0.3]}), "one number for all channels"),
    "half infinite": (_changed(tau=[1.0, "inf", 1.0]), "all channels are infinite, or none"),
    "unknown layer": (_changed(kind="interface"), "layers[1].kind = interface"),
    "unknown phase": (_changed(phase={"kind": "draine"}), "layers[1].phase.kind = draine"),
}


@pytest.mark.parametrize(("data", "sentence"), REFUSED.values(), ids=REFUSED)
def test_what_the_panel_cannot_hold_is_refused_whole(addon, material, data, sentence):
    before = addon.stack_io.to_dict(material)
    with pytest.raises(addon.stack_io.PanelStackError) as caught:
        addon.stack_io.assign(material, data)
    assert sentence in str(caught.value) and "\n" not in str(caught.value)
    assert addon.stack_io.to_dict(material) == before


@pytest.mark.parametrize("text", ['{"schema": 1, "layers": [', "[]", '{"schema": 99, "layers": []}', "{}"])
def test_a_bad_file_is_one_sentence_and_changes_nothing(addon, material, lamina, call, tmp_path, text):
    before = addon.stack_io.to_dict(material)
    path = tmp_path / "bad.json"
    path.write_text(text)
    with pytest.raises(RuntimeError) as caught:
        call(bpy.ops.lamina.stack_import, material, filepath=str(path))
    assert "Traceback" not in str(caught.value)
    assert addon.stack_io.to_dict(material) == before


def test_a_missing_file_is_named(addon, material, lamina, call, tmp_path):
    with pytest.raises(RuntimeError, match="nowhere.json: No such file"):
        call(bpy.ops.lamina.stack_import, material, filepath=str(tmp_path / "nowhere.json"))


@pytest.mark.parametrize("value", [0.9, 0.1, 1e-7, 1e6, 0.0014, 1 / 3, 0.0, 1.0, 123456.7])
def test_shortest_is_the_same_float32(addon, value):
    import struct

    single = struct.unpack("f", struct.pack("f", value))[0]
    text = addon.stack_io.shortest(single)
    assert struct.pack("f", text) == struct.pack("f", value)
    assert len(repr(text)) <= len(repr(single))
