# SPDX-License-Identifier: GPL-3.0-or-later
"""The state of a bake relative to the layers, the quality and the basis in the panel."""

from types import SimpleNamespace

import pytest
from addon_helpers import drawn


@pytest.fixture
def told(addon):
    """told(material): the state that the result box shows, as one text."""
    preferences = SimpleNamespace(system=SimpleNamespace(ui_scale=1.0))  # without a window Blender's own is 0
    context = SimpleNamespace(preferences=preferences, region=SimpleNamespace(width=800))
    return lambda material: " ".join(drawn(addon.ui.panel._draw_state, context, material))


@pytest.fixture
def listed(addon, lamina, capsys):
    """listed(): the output of `list` for the only material."""

    def listed():
        capsys.readouterr()
        assert addon.command_line.command.main(["list"]) == 0
        return capsys.readouterr().out.strip()

    return listed


BAKED = {"quality": "preview", "basis": "standard"}
OTHERS = {
    "better quality": ({}, {"quality": "final"}, "quality Preview instead of Final"),
    "better basis": ({}, {"basis": "accurate"}, "fit Standard instead of Accurate"),
    "both": ({}, {"quality": "final", "basis": "accurate"},
             "quality Preview instead of Final, fit Standard instead of Accurate"),
    "lower quality": ({"quality": "final"}, {}, "quality Final instead of Preview"),
    "lower basis": ({"basis": "accurate"}, {}, "fit Accurate instead of Standard"),
}  # fmt: skip


@pytest.mark.parametrize(("baked", "chosen", "sentence"), OTHERS.values(), ids=OTHERS)
def test_a_bake_at_other_settings_than_the_chosen_is_not_up_to_date(
    addon, lamina, material, told, listed, baked, chosen, sentence
):
    addon.baking.bake_job.bake_material(material, **(BAKED | baked))
    for name, value in (BAKED | baked).items():
        setattr(material.lamina, name, value)
    assert addon.baking.bake_job.state(material) == "fresh" and told(material) == "Up to date"
    assert listed() == "Bronze: 1 layer, up to date"
    for name, value in (BAKED | chosen).items():
        setattr(material.lamina, name, value)
    assert addon.baking.bake_job.state(material) == "other"
    assert told(material) == f"Out of date: baked with {sentence}"
    assert listed() == f"Bronze: 1 layer, out of date, baked with {sentence}"
    material.lamina.layers[0].tau = 3.3
    assert addon.baking.bake_job.state(material) == "stale", "changed layers are told first"


def test_a_bake_without_a_word_of_its_basis_was_of_the_standard_one(addon, lamina, material):
    addon.baking.bake_job.bake_material(material)
    material.lamina.result.basis = ""
    assert addon.baking.bake_job.state(material) == "fresh"
    material.lamina.basis = "accurate"
    assert addon.baking.bake_job.state(material) == "other"


def test_a_bake_by_a_version_whose_results_have_changed_is_out_of_date(
    addon, lamina, material, told, listed, monkeypatch
):
    changes = addon.base.native.part("baking.report.result_changes")
    addon.baking.bake_job.bake_material(material)
    assert material.lamina.result.version == lamina.__version__
    monkeypatch.setattr(changes._core, "__version__", "0.3.0")
    table = [changes.Change("0.2.0", "dust", lambda stack: stack.varying is not None)]
    monkeypatch.setattr(changes, "CHANGES", table)
    material.lamina.layers[0].varying = False
    addon.baking.bake_job.bake_material(material)
    material.lamina.result.version = "0.1.0"
    assert addon.baking.bake_job.state(material) == "fresh", "the change does not concern this stack"
    material.lamina.layers[0].varying = True
    addon.baking.bake_job.bake_material(material)
    assert addon.baking.bake_job.state(material) == "fresh", "baked by the version that runs"
    material.lamina.result.version = "0.1.0"
    assert addon.baking.bake_job.state(material) == "older"
    assert told(material) == "Out of date: baked by 0.1.0; 0.2.0 changed dust"
    assert listed() == "Bronze: 1 layer, out of date, baked by 0.1.0; 0.2.0 changed dust"


def live_bake(addon, material, coarse=None):
    """One bake as live editing makes it, without its timer."""
    job = addon.baking.live.LiveJob(material, None, coarse or {})
    job.wait(60.0)
    job.show(material, addon.baking.live._follow(material))


def test_live_editing_shows_a_preview_and_says_so(addon, lamina, material, told, listed):
    settings = material.lamina
    settings.quality, settings.basis, settings.live = "final", "accurate", True
    live_bake(addon, material)
    assert addon.baking.bake_job.state(material) == "live"
    assert told(material) == "Live preview of these layers; Bake makes Final, Accurate"
    difference = "quality Preview instead of Final, fit Standard instead of Accurate"
    assert listed() == f"Bronze: 1 layer, live preview, {difference}"
    settings.live = False
    assert addon.baking.bake_job.state(material) == "other", "without Live it is a bake like any other"
    settings.quality, settings.basis, settings.live = "preview", "standard", True
    assert addon.baking.bake_job.state(material) == "fresh", "where a preview is chosen the preview is all there is"


def test_a_final_bake_under_live_is_not_called_a_preview(addon, lamina, material, told):
    addon.baking.bake_job.bake_material(material, quality="final")
    material.lamina.live = True
    assert told(material) == "Out of date: baked with quality Final instead of Preview"
    material.lamina.quality = "final"
    assert told(material) == "Up to date"


def test_a_live_bake_that_leaves_something_out_is_never_up_to_date(addon, lamina, material, told):
    live_bake(addon, material, {"nodes": 8})
    assert told(material) == "Out of date: baked with quality Coarse instead of Preview"
    material.lamina.live = True
    assert addon.baking.bake_job.state(material) == "live"
    assert addon.baking.live._needs_bake(material), "turning Live on has the rest worked out"


def test_turning_live_on_bakes_only_what_is_not_shown_yet(addon, lamina, material):
    addon.baking.bake_job.bake_material(material, quality="final")
    assert not addon.baking.live._needs_bake(material)
    material.lamina.layers[0].tau = 3.3
    assert addon.baking.live._needs_bake(material)
