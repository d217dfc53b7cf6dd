# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties <-> stack JSON."""

import json

import bpy
import pytest

HG = {"kind": "hg", "g": 0.75}


DOUBLE = {"kind": "double-hg", "g1": 0.85, "g2": -0.4, "weight": 0.95}
DRAINE = {"kind": "draine", "g": 0.3, "alpha": 12.5}
TABLE = {"kind": "tabulated", "moments": [1.0, 0.12345678901234567, 0.05]}
MIXTURE = {
    "kind": "mixture",
    "parts": [
        {"share": [0.25, 0.5, 0.125], "phase": {"kind": "hg", "g": 0.941234567890123}},
        {"share": [0.75, 0.5, 0.875], "phase": {"kind": "tabulated", "cosines": [-1, 0.2, 1], "values": [1, 2, 9]}},
    ],
}  # fmt: skip
GOLD = {"eta": [0.143, 0.374, 1.442], "k": [3.983, 2.385, 1.603]}


def medium(name, phase, varying=False, **numbers):
    return {"kind": "medium", "name": name, **numbers, "phase": phase, "varying": varying}


def interface(name, **more):
    return {"kind": "interface", "name": name, **more}


def film(name, **more):
    return {"kind": "film", "name": name, **more}


def flakes(name, **more):
    return {"kind": "flakes", "name": name, **more}


def conductor(**more):
    return {"kind": "conductor", **more}


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
    "pane": stack(
        [
            interface("front", ior=1.5, alpha=0.1, distribution="beckmann", compensate=False, correlated=False),
            medium("glass", {"kind": "cornette-shanks", "g": 0.7}, albedo=[0.1, 0.2, 0.3], tau=0.05),
            interface("back", ior=1.0, alpha=0.3),
        ],
        None,
    ),
    "dispersion": stack([interface("prism", ior=[1.51, 1.52, 1.53], alpha=0.0)], conductor(**GOLD, alpha=0.04)),
    "all facets": stack(
        [medium("haze", DOUBLE, albedo=0.5, tau=0.1)],
        conductor(eta=1.5, k=7.0, alpha=0.09, distribution="beckmann", compensate=False, correlated=False),
    ),
    "droplets": stack(
        [medium("fog", DRAINE, albedo=0.9, tau=0.1)], {"kind": "half-space", "albedo": 0.5, "phase": DOUBLE}
    ),
    "half-space per mm": stack(
        [interface("skin", ior=1.4, alpha=0.3)],
        {"kind": "half-space", "sigma_s": [2.55, 3.21, 3.77], "sigma_a": [1e-6, 0.0024, 0.0], "phase": HG},
    ),
    "imported": stack(
        [medium("table", TABLE, albedo=0.9, tau=0.1), medium("mixture", MIXTURE, albedo=0.9, tau=0.1)],
        {"kind": "half-space", "albedo": 0.5, "phase": {"kind": "hg", "g": [0.1, 0.2, 0.3]}},
    ),
    "colours": stack(
        [
            medium("veil", HG, color=[0.2, 0.25, 0.3], over=[0.2, 0.3, 0.4], tau=0.5),
            medium("paint", {"kind": "isotropic"}, color=0.6, tau="inf"),
        ],
        None,
    ),
    "metal by colours": stack([], conductor(facing=[1.0, 0.766, 0.336], grazing=[1.0, 0.9, 0.8], alpha=0.0)),
    "brushed": stack(
        [interface("coat", ior=1.5, alpha=0.1, alpha_v=0.3)],
        conductor(eta=0.2, k=3.0, alpha=0.08, alpha_v=0.35, angle=-0.6),
    ),
    "films": stack(
        [interface("lacquer", ior=1.5, alpha=0.0), film("seal", ior=1.38, k=0.0, thickness=100.0),
         film("oxide", ior=2.4, k=0.05, thickness=49.0)],
        conductor(**GOLD, alpha=0.15),
    ),
    "flakes": stack(
        [interface("coat", ior=1.5, alpha=0.0),
         flakes("pearl", reflectance=[0.9, 0.8, 0.7], tau=0.5, alpha=0.3, binder=[0.1, 0.2, 0.4], varying=True),
         flakes("gold", facing=[1.0, 0.766, 0.336], grazing=[1.0, 0.9, 0.8], tau=2.0, alpha=0.15, binder=0.0)],
        {"kind": "lambert", "reflectance": 0.1},
    ),
    "textured": stack(
        [medium("dust", HG, albedo=0.9, tau=0.3)], {"kind": "lambert", "reflectance": 0.5, "textured": True}
    ),
    "shader": stack(
        [medium("dust", HG, albedo=0.9, tau=0.3)], {"kind": "shader", "reflectance": [0.5, 0.4, 0.3]}
    ),
    "principled": stack(
        [medium("dust", HG, albedo=0.9, tau=0.3)],
        {"kind": "principled", "color": [0.8, 0.3, 0.1], "metallic": 1.0, "roughness": 0.3, "ior": 1.4,
         "specular": 0.4, "coat": 0.5, "coat_roughness": 0.1, "coat_ior": 1.6, "inputs": ["color", "roughness"]},
    ),
}


@pytest.mark.parametrize("data", STACKS.values(), ids=STACKS)
def test_round_trip_is_exact(addon, material, data):
    addon.editing.stack_io.assign(material, data)
    assert addon.editing.stack_io.to_dict(material) == data


@pytest.mark.parametrize("data", STACKS.values(), ids=STACKS)
def test_the_panel_hashes_like_python(addon, material, lamina, data):
    addon.editing.stack_io.assign(material, data)
    assert addon.editing.stack_io.to_stack(material).hash == lamina.Stack.from_json(data).hash


@pytest.mark.parametrize("data", STACKS.values(), ids=STACKS)
def test_files(addon, material, lamina, tmp_path, data):
    path = tmp_path / "stack.json"
    path.write_text(json.dumps(data))
    addon.editing.stack_io.import_file(material, str(path))
    other = tmp_path / "other.json"
    addon.editing.stack_io.export_file(material, str(other))
    assert lamina.Stack.load(str(other)).hash == lamina.Stack.load(str(path)).hash


def test_operators_do_what_the_functions_do(addon, material, lamina, call, tmp_path):
    path, exported = tmp_path / "in.json", tmp_path / "out.json"
    path.write_text(json.dumps(STACKS["optical"]))
    assert call(bpy.ops.lamina.stack_import, material, filepath=str(path)) == {"FINISHED"}
    assert addon.editing.stack_io.to_dict(material) == STACKS["optical"]
    assert call(bpy.ops.lamina.stack_export, material, filepath=str(exported)) == {"FINISHED"}
    assert lamina.Stack.load(str(exported)).hash == lamina.Stack.load(str(path)).hash


def test_paths_may_begin_at_the_blend_file(addon, material, lamina, call, tmp_path):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "file.blend"))
    assert call(bpy.ops.lamina.stack_export, material, filepath="//out.json") == {"FINISHED"}
    assert (tmp_path / "out.json").is_file()
    assert call(bpy.ops.lamina.stack_import, material, filepath="//out.json") == {"FINISHED"}


def test_importing_gives_a_plain_material_a_stack(addon, lamina, tmp_path):
    plain = bpy.data.materials.new("Plain")
    path = tmp_path / "stack.json"
    path.write_text(json.dumps(STACKS["infinite"]))
    addon.editing.stack_io.import_file(plain, str(path))
    assert plain.lamina.enabled and plain.lamina.schema == addon.properties.material_properties.SCHEMA


def _changed(**changes):
    data = json.loads(json.dumps(STACKS["optical"]))
    data["layers"][1].update(changes)
    return data


REFUSED = {
    "two channels": (_changed(albedo=[0.5, 0.6]), "layers[1].albedo has 2 channels"),
    "five channels": (_changed(tau=[1, 2, 3, 4, 5]), "layers[1].tau has 5 channels"),
    "two anisotropies": (_changed(phase={"kind": "hg", "g": [0.1, 0.2]}), "layers[1].phase.g has 2 channels"),
    "a mixture in two channels": (
        _changed(phase={"kind": "mixture", "parts": [{"share": [0.5, 1.0], "phase": HG}]}),
        "layers[1].phase.parts[0].share has 2 channels",
    ),
    "half infinite": (_changed(tau=[1.0, "inf", 1.0]), "all channels are infinite, or none"),
    "unknown layer": (_changed(kind="granules"), "layers[1].kind = granules"),
    "unknown base": ({**_changed(), "base": {"kind": "velvet"}}, "base.kind = velvet"),
    "roughness per channel": (
        stack([interface("odd", ior=1.5, alpha=[0.1, 0.2, 0.3])], None),
        "layers[0].alpha = [0.1, 0.2, 0.3]: in Blender it is one number",
    ),
    "amount of flakes per channel": (
        stack([flakes("odd", reflectance=0.5, tau=[1.0, 2.0, 3.0], alpha=0.2)], None),
        "layers[0].tau = [1.0, 2.0, 3.0]: in Blender it is one number for all channels",
    ),
    "a film's spectrum": (
        stack([film("oxide", ior={"wavelengths": [400, 700], "values": [2.5, 2.3]}, thickness=49)], conductor(**GOLD)),
        "layers[0].ior: in Blender it is one number for all wavelengths",
    ),
    "wavelengths": (
        {**stack([], {"kind": "lambert", "reflectance": 0.5}), "wavelengths": [550]},
        "wavelengths: in Blender the channels of a stack are red, green and blue",
    ),
    "unknown facets": (
        stack([interface("odd", ior=1.5, distribution="student")], None),
        "layers[0].distribution = student",
    ),
}


@pytest.mark.parametrize(("data", "sentence"), REFUSED.values(), ids=REFUSED)
def test_what_the_panel_cannot_hold_is_refused_whole(addon, material, data, sentence):
    before = addon.editing.stack_io.to_dict(material)
    with pytest.raises(addon.base.messages.RefusedError) as caught:
        addon.editing.stack_io.assign(material, data)
    assert sentence in str(caught.value) and "\n" not in str(caught.value)
    assert addon.editing.stack_io.to_dict(material) == before


@pytest.mark.parametrize("text", ['{"schema": 1, "layers": [', "[]", '{"schema": 99, "layers": []}', "{}"])
def test_a_bad_file_is_one_sentence_and_changes_nothing(addon, material, lamina, call, tmp_path, text):
    before = addon.editing.stack_io.to_dict(material)
    path = tmp_path / "bad.json"
    path.write_text(text)
    with pytest.raises(RuntimeError) as caught:
        call(bpy.ops.lamina.stack_import, material, filepath=str(path))
    assert "Traceback" not in str(caught.value)
    assert addon.editing.stack_io.to_dict(material) == before


def test_a_missing_file_is_named(addon, material, lamina, call, tmp_path):
    with pytest.raises(RuntimeError, match="nowhere.json: No such file"):
        call(bpy.ops.lamina.stack_import, material, filepath=str(tmp_path / "nowhere.json"))


@pytest.mark.parametrize("value", [0.9, 0.1, 1e-7, 1e6, 0.0014, 1 / 3, 0.0, 1.0, 123456.7])
def test_shortest_is_the_same_float32(addon, value):
    import struct

    single = struct.unpack("f", struct.pack("f", value))[0]
    text = addon.base.decimals.shortest(single)
    assert struct.pack("f", text) == struct.pack("f", value)
    assert len(repr(text)) <= len(repr(single))


@pytest.mark.parametrize("roughness", [0.0, 0.1, 0.3, 1 / 3, 0.55, 1.0])
def test_roughness_is_the_root_of_alpha(addon, material, roughness):
    base = material.lamina.base
    base.kind, base.roughness = "conductor", roughness
    assert base.roughness == pytest.approx(roughness, abs=1e-6)
    assert addon.editing.stack_io.to_dict(material)["base"]["alpha"] == pytest.approx(roughness**2, rel=2e-6)


def test_a_typed_roughness_makes_a_short_alpha(addon, material):
    material.lamina.base.kind, material.lamina.base.roughness = "conductor", 0.3
    assert addon.editing.stack_io.to_dict(material)["base"]["alpha"] == 0.09


IMPORTED = {
    "mixture of 2": MIXTURE,
    "table of 3 moments": TABLE,
    "table of 4 samples": {"kind": "tabulated", "cosines": [-1, 0, 0.5, 1], "values": [[1, 1, 2, 3]] * 3},
    "Henyey-Greenstein per channel": {"kind": "hg", "g": [0.1, 0.2, 0.3]},
    "from-a-newer-lamina": {"kind": "from-a-newer-lamina", "size": 3},
}


@pytest.mark.parametrize(("words", "phase"), IMPORTED.items(), ids=IMPORTED)
def test_an_imported_phase_function_is_kept_word_for_word(addon, material, call, words, phase):
    addon.editing.stack_io.assign(material, _changed(phase=phase))
    layer = material.lamina.layers[1]
    assert addon.editing.stack_io.to_dict(material)["layers"][1]["phase"] == phase
    assert addon.stack_json.phases.imported(layer) == words
    assert addon.stack_json.phases.imported(material.lamina.layers[0]) == ""
    material.lamina.active_index = 1
    assert call(bpy.ops.lamina.phase_replace, material) == {"FINISHED"}
    assert addon.stack_json.phases.imported(layer) == "" and layer.phase == "hg"


def test_replacing_the_phase_function_of_the_base(addon, material, call):
    addon.editing.stack_io.assign(material, STACKS["imported"])
    call(bpy.ops.lamina.phase_replace, material, base=True)
    assert not material.lamina.base.phase_text and material.lamina.layers[0].phase_text


@pytest.mark.parametrize("text", ["{", "[1]", "null", '{"kind": 3}', "[" * 100000])
def test_a_damaged_phase_text_is_one_sentence(addon, material, lamina, text):
    material.lamina.layers[0].phase_text = text
    assert addon.stack_json.phases.imported(material.lamina.layers[0])
    with pytest.raises(lamina.StackError) as caught:
        addon.editing.stack_io.to_stack(material)
    sentence = addon.base.messages.sentence(caught.value, material)
    assert sentence.startswith("Layer 1 “Dust”, phase function") and "\n" not in sentence


def test_what_a_stack_says_of_itself_is_kept(addon, material):
    data = {**STACKS["infinite"], "name": "Snow", "source": "seen"}
    addon.editing.stack_io.assign(material, data)
    assert addon.editing.stack_io.to_dict(material) == data
    addon.editing.stack_io.assign(material, STACKS["infinite"])
    assert addon.editing.stack_io.to_dict(material) == STACKS["infinite"]


def test_asking_again_for_the_same_stack_is_cheap_and_errors_repeat(addon, material, lamina):
    assert addon.editing.stack_io.to_stack(material) is addon.editing.stack_io.to_stack(material)
    material.lamina.layers[0].infinite = material.lamina.layers[0].varying = True
    for _ in range(2):
        with pytest.raises(lamina.StackError, match="largest thickness"):
            addon.editing.stack_io.to_stack(material)
