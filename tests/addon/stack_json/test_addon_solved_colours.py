# SPDX-License-Identifier: GPL-3.0-or-later
"""The colour for an albedo and the albedo for a colour; the panel draws every kind of layer."""

import sys
import time
from types import ModuleType

import pytest
from addon_helpers import Layout, drawn_base, drawn_layer

ERROR = ValueError("no good")


@pytest.fixture
def colours(addon, lamina, monkeypatch):
    """Colours that are half the albedo, in place of the real solver; every solve is noted."""
    module = ModuleType("lamina.colours")
    module.asked = []

    def shown(medium, over=None):
        module.asked.append(medium)
        values = medium.albedo if isinstance(medium.albedo, tuple | list) else [medium.albedo]
        return [0.5 * value for value in values]

    module.shown = shown
    monkeypatch.setitem(sys.modules, "lamina.colours", module)
    yield module
    addon.stack_json.solved_colours.unregister()


def look_until_rest(shown, seconds=20.0):
    deadline = time.monotonic() + seconds
    while shown.look() is not None:
        assert time.monotonic() < deadline
        time.sleep(0.001)


def test_the_answer_comes_after_the_question(addon, material, colours):
    layer = material.lamina.layers[0]
    layer.albedo = (0.2, 0.4, 0.8)
    assert tuple(layer.shown_colour) == (0.0, 0.0, 0.0) and not colours.asked
    look_until_rest(addon.stack_json.solved_colours)
    assert tuple(layer.shown_colour) == pytest.approx((0.1, 0.2, 0.4))
    assert len(colours.asked) == 1 and colours.asked[0].tau == float("inf")


def test_the_old_answer_stays_until_the_new_one_is_there(addon, material, colours):
    layer = material.lamina.layers[0]
    layer.albedo = (0.2, 0.4, 0.8)
    addon.stack_json.solved_colours.thick_colour(layer)
    look_until_rest(addon.stack_json.solved_colours)
    assert addon.stack_json.solved_colours.thick_colour(layer)
    layer.albedo = (0.4, 0.4, 0.8)
    assert addon.stack_json.solved_colours.thick_colour(layer) == pytest.approx((0.1, 0.2, 0.4))
    look_until_rest(addon.stack_json.solved_colours)
    assert addon.stack_json.solved_colours.thick_colour(layer) == pytest.approx((0.2, 0.2, 0.4))


def test_only_the_newest_question_is_worked_out_and_none_twice(addon, material, colours):
    layer = material.lamina.layers[0]
    for step in range(50):
        layer.albedo = (0.01 * step,) * 3
        addon.stack_json.solved_colours.thick_colour(layer)
    look_until_rest(addon.stack_json.solved_colours)
    assert len(colours.asked) == 1 and colours.asked[0].albedo == (0.49,)
    layer.name, layer.tau = "Other", 9.0
    assert addon.stack_json.solved_colours.thick_colour(layer) == pytest.approx((0.245,) * 3)
    look_until_rest(addon.stack_json.solved_colours)
    assert len(colours.asked) == 1


def test_asking_again_starts_nothing(addon, material, colours):
    layer = material.lamina.layers[0]
    addon.stack_json.solved_colours.thick_colour(layer)
    look_until_rest(addon.stack_json.solved_colours)
    for _ in range(100):
        addon.stack_json.solved_colours.thick_colour(layer)
    assert addon.stack_json.solved_colours.look() is None and len(colours.asked) == 1


def test_a_layer_without_an_answer_shows_none(addon, material, colours):
    layer = material.lamina.layers[0]
    layer.phase_text = "{"
    addon.stack_json.solved_colours.thick_colour(layer)
    look_until_rest(addon.stack_json.solved_colours)
    assert addon.stack_json.solved_colours.thick_colour(layer) == () and not colours.asked


def test_a_stack_with_colours_is_checked_in_the_thread(addon, material, lamina, monkeypatch):
    asked = []
    monkeypatch.setattr(addon.stack_json.stack_check, "_ask", lambda _lamina, text: asked.append(text) or (None, ERROR))
    material.lamina.layers[0].mode = "colour"
    assert addon.ui.state_line.stack_error(material) == "" and not asked
    look_until_rest(addon.stack_json.solved_colours)
    assert len(asked) == 1
    assert addon.ui.state_line.stack_error(material) == "ValueError: no good"
    assert addon.ui.state_line.error_layer(material) is None and len(asked) == 1
    addon.stack_json.stack_check.forget()
    assert addon.ui.state_line.stack_error(material) == ""
    look_until_rest(addon.stack_json.solved_colours)
    assert addon.ui.state_line.stack_error(material) == "ValueError: no good" and len(asked) == 2
    addon.stack_json.solved_colours.unregister()


def test_a_bug_in_the_thread_is_not_asked_for_again_and_again(addon, material, lamina, monkeypatch):
    asked = []
    monkeypatch.setattr(addon.stack_json.stack_check, "_ask", lambda _lamina, text: asked.append(text) or 1 / 0)
    material.lamina.layers[0].mode = "colour"
    for _ in range(3):
        assert addon.ui.state_line.stack_error(material) == ""
        look_until_rest(addon.stack_json.solved_colours)
    assert len(asked) == 1
    addon.stack_json.solved_colours.unregister()


def test_the_real_colours(addon, material, lamina):
    layer = material.lamina.layers[0]
    layer.albedo, layer.infinite = (0.3, 0.6, 0.95), True
    text = addon.stack_json.solved_colours._text(layer, "colour")
    colour = addon.stack_json.solved_colours.answer("colour", text)
    assert len(colour) == 3 and 0.0 < colour[0] < colour[1] < colour[2] < 0.95
    layer.mode, layer.colour = "colour", colour
    colours = addon.stack_json.solved_colours
    albedo = colours.answer("albedo", colours._text(layer, "albedo"))
    assert albedo == pytest.approx((0.3, 0.6, 0.95), abs=1e-4)


@pytest.mark.parametrize("mode", ["colour", "optical", "coefficients"])
@pytest.mark.parametrize("infinite", [False, True])
@pytest.mark.parametrize("phase", ["isotropic", "hg", "double-hg", "draine", "cornette-shanks", "rayleigh"])
def test_every_medium_can_be_drawn(addon, material, mode, infinite, phase):
    layer = material.lamina.layers[0]
    layer.mode, layer.infinite, layer.phase = mode, infinite, phase
    lines = drawn_layer(addon, layer)
    assert {"Phase", "Varying"} <= set(lines)
    assert ("Albedo" in lines) == (mode != "coefficients") and ("As Thick Layer" in lines) == (mode != "colour")


def test_no_swatch_of_an_unknown_color(addon, material, monkeypatch):
    monkeypatch.setattr(addon.base.native, "_package", None)
    lines = drawn_layer(addon, material.lamina.layers[0])
    assert "Albedo" in lines and "As Thick Layer" not in lines


def test_an_imported_phase_function_is_shown_read_only(addon, material):
    layer = material.lamina.layers[0]
    layer.phase_text = '{"kind": "mixture", "parts": [{}, {}]}'
    lines = drawn_layer(addon, layer)
    assert "Imported: mixture of 2" in lines and "Anisotropy" not in lines


@pytest.mark.parametrize("per_channel", [False, True])
def test_interfaces_can_be_drawn_and_told_in_short(addon, material, per_channel):
    layer = addon.editing.layer_list.add_layer(material, "interface")
    layer.ior_per_channel, layer.ior_rgb = per_channel, (1.5, 1.51, 1.52)
    assert {"Roughness", "Distribution", "Keep Energy"} <= set(drawn_layer(addon, layer))
    ior = "1.5/1.51/1.52" if per_channel else "1.5"
    assert addon.ui.fields.facts(layer) == f"ior {ior}, smooth"
    layer.roughness = 0.3
    assert addon.ui.fields.facts(layer) == f"ior {ior}, rough 0.3"


BASES = {
    "none": set(),
    "lambert": {"Reflectance", "Base Color from Input"},
    "black": set(),
    "half-space": {"Albedo", "Phase"},
    "conductor": {"Metal", "Roughness", "Facing", "Grazing"},
}


@pytest.mark.parametrize(("kind", "expected"), BASES.items())
def test_every_base_can_be_drawn(addon, material, kind, expected):
    base = material.lamina.base
    base.kind = kind
    assert expected <= set(drawn_base(addon, base))
    base.metal_form = "indices"
    lines = set(drawn_base(addon, base))
    assert kind != "conductor" or {"Metal", "Index n R", "Extinction k R"} <= lines
    base.half_space_form = "coefficients"
    lines = set(drawn_base(addon, base))
    expected = {"Scattering (1/mm) R", "Absorption (1/mm) R", "Phase"}
    assert kind != "half-space" or (expected <= lines and "Albedo" not in lines)


def test_menus_can_be_drawn(addon, material, lamina, monkeypatch, tmp_path):
    monkeypatch.setattr(addon.editing.presets, "user_folder", lambda create=False: tmp_path)
    addon.editing.presets.save_user(material, "Mine")
    for name in dir(addon.ui.menus):
        if name.startswith("LAMINA_MT_"):
            menu = type("Menu", (), {"layout": Layout()})()
            getattr(addon.ui.menus, name).draw(menu, None)
            assert menu.layout.lines, name
            assert "user_presets" not in name or "Mine" in menu.layout.lines
