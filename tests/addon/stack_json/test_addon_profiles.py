# SPDX-License-Identifier: GPL-3.0-or-later
"""Media that change with depth: top and bottom in the panel, longer profiles stored unchanged."""

import json

import bpy
import pytest
from addon_helpers import drawn_layer

HG = {"kind": "hg", "g": 0.75}
ISOTROPIC = {"kind": "isotropic"}


def stack(**medium):
    layer = {"kind": "medium", "name": "silt", "varying": False, **medium}
    return {"schema": 1, "layers": [layer], "base": {"kind": "lambert", "reflectance": 0.5}}


ENDS = {
    "albedo": stack(
        tau=2.0,
        profile=[
            {"depth": 0.0, "albedo": [0.9, 0.8, 0.7], "phase": HG},
            {"depth": 1.0, "albedo": 0.5, "phase": ISOTROPIC},
        ],
    ),
    "coefficients": stack(
        thickness=0.25,
        profile=[
            {"depth": 0.0, "sigma_s": [0.7, 1.22, 1.9], "sigma_a": 0.01, "phase": HG},
            {"depth": 1.0, "sigma_s": 4.0, "sigma_a": [0.0, 0.1, 0.2], "phase": {"kind": "hg", "g": -0.2}},
        ],
    ),
    "colour": stack(
        tau=[1.0, 2.0, 3.0],
        profile=[
            {"depth": 0.0, "color": [0.2, 0.3, 0.4], "phase": ISOTROPIC},
            {"depth": 1.0, "color": [0.6, 0.5, 0.4], "phase": ISOTROPIC},
        ],
    ),
}
LONG = stack(
    tau=1.0,
    profile=[
        {"depth": 0.0, "albedo": 0.9, "phase": HG},
        {"depth": 0.3, "albedo": [0.9, 0.8, 0.1], "phase": ISOTROPIC},
        {"depth": 0.3, "albedo": 0.2, "phase": ISOTROPIC},
        {"depth": 1.0, "albedo": 0.125, "phase": ISOTROPIC},
    ],
)
MIXED = stack(tau=1.0, profile=[{"depth": 0.0, "albedo": 0.9, "phase": HG}, {"depth": 1.0, "color": 0.5, "phase": HG}])
ALL = {**ENDS, "long": LONG, "mixed": MIXED}


@pytest.mark.parametrize("data", ALL.values(), ids=ALL)
def test_round_trip_is_exact_and_hashes_like_python(addon, material, lamina, data):
    addon.editing.stack_io.assign(material, data)
    assert addon.editing.stack_io.to_dict(material) == data
    assert addon.editing.stack_io.to_stack(material).hash == lamina.Stack.from_json(data).hash


@pytest.mark.parametrize("data", ALL.values(), ids=ALL)
def test_what_lamina_writes_is_read(addon, material, lamina, data):
    written = lamina.Stack.from_json(data)
    addon.editing.stack_io.assign_stack(material, written)
    assert addon.editing.stack_io.to_stack(material).hash == written.hash


def test_the_bottom_starts_as_the_top_is_and_then_stays(addon, material):
    layer = material.lamina.layers[0]
    layer.albedo, layer.phase, layer.g = (0.1, 0.2, 0.3), "hg", 0.4
    layer.graded = True
    top, bottom = addon.editing.stack_io.to_dict(material)["layers"][0]["profile"]
    assert top == {**bottom, "depth": 0.0} and bottom["depth"] == 1.0
    layer.bottom.g = -0.5
    layer.graded = False
    assert "profile" not in addon.editing.stack_io.to_dict(material)["layers"][0]
    layer.g = 0.6
    layer.graded = True
    knots = addon.editing.stack_io.to_dict(material)["layers"][0]["profile"]
    assert [knot["phase"]["g"] for knot in knots] == [0.6, -0.5]


def test_a_constant_profile_is_the_homogeneous_layer(addon, material, lamina):
    import numpy as np

    layer = material.lamina.layers[0]
    layer.albedo, layer.tau = (0.8, 0.8, 0.8), 0.7
    plain = lamina.solve(addon.editing.stack_io.to_stack(material))
    layer.graded = True
    graded = lamina.solve(addon.editing.stack_io.to_stack(material))
    assert np.allclose(graded.reflectance([0.3, 0.9]), plain.reflectance([0.3, 0.9]), rtol=1e-6)


def test_infinity_is_for_media_that_do_not_change(addon, material, lamina):
    layer = material.lamina.layers[0]
    layer.infinite = layer.graded = True
    assert addon.editing.stack_io.to_dict(material)["layers"][0]["tau"] == layer.tau
    addon.editing.stack_io.to_stack(material)
    assert "∞" not in drawn_layer(addon, layer) and "∞" not in addon.ui.fields.facts(layer)


def test_a_copied_layer_has_its_bottom(addon, material):
    addon.editing.stack_io.assign(material, ENDS["albedo"])
    addon.editing.layer_list.duplicate_layer(material)
    first, second = addon.editing.stack_io.to_dict(material)["layers"]
    assert first["profile"] == second["profile"]


@pytest.mark.parametrize("data", ENDS.values(), ids=ENDS)
def test_top_and_bottom_are_drawn(addon, material, data):
    addon.editing.stack_io.assign(material, data)
    lines = drawn_layer(addon, material.lamina.layers[0])
    assert "At the Bottom" in lines and lines.count("Phase") == 2


def test_a_long_profile_is_shown_and_can_be_replaced(addon, material, call):
    addon.editing.stack_io.assign(material, LONG)
    layer = material.lamina.layers[0]
    assert "Imported: 4 depths" in drawn_layer(addon, layer)
    assert call(bpy.ops.lamina.profile_replace, material) == {"FINISHED"}
    knots = addon.editing.stack_io.to_dict(material)["layers"][0]["profile"]
    assert [knot["depth"] for knot in knots] == [0.0, 1.0]
    assert [knot["albedo"] for knot in knots] == [0.9, 0.125]


def test_the_bottom_keeps_an_imported_phase_function(addon, material, call):
    table = {"kind": "tabulated", "moments": [1.0, 0.2, 0.05]}
    data = json.loads(json.dumps(ENDS["albedo"]))
    data["layers"][0]["profile"][1]["phase"] = table
    addon.editing.stack_io.assign(material, data)
    assert addon.editing.stack_io.to_dict(material) == data
    call(bpy.ops.lamina.phase_replace, material, bottom=True)
    assert material.lamina.layers[0].bottom.phase_text == ""


@pytest.mark.parametrize("text", ["{", '{"kind": 3}', "[1]", "[" * 100000])
def test_a_damaged_profile_is_one_sentence(addon, material, lamina, text):
    material.lamina.layers[0].profile_text = text
    assert addon.stack_json.profiles.imported(material.lamina.layers[0])
    with pytest.raises(lamina.StackError) as caught:
        addon.editing.stack_io.to_stack(material)
    sentence = addon.base.messages.sentence(caught.value, material)
    assert sentence.startswith("Layer 1 “Dust”") and "\n" not in sentence


def test_an_error_at_the_bottom_says_so(addon, material):
    text = "layers[0].profile[1].albedo[2] = 1.2: must lie in [0, 1]"
    words = "Layer 1 “Dust”, bottom, albedo (blue) = 1.2: must lie in [0, 1]"
    assert addon.base.messages.in_panel_words(text, material) == words
