# SPDX-License-Identifier: GPL-3.0-or-later
"""A stack may be given as an object, a preset's id or a path; results are short to print and can be pickled."""

import pickle

import numpy as np
import pytest

import lamina
from lamina import cli
from lamina.common.errors import ArgumentError

PRESET = "soot-on-brick"
MARBLE = "marble-honed"


@pytest.fixture(params=["object", "id", "path", "text"])
def given(request, tmp_path):
    """(a way to give the preset's stack, the stack)."""
    stack = lamina.presets.load(PRESET)
    path = tmp_path / "stack.json"
    stack.save(path)
    return {"object": stack, "id": PRESET, "path": path, "text": str(path)}[request.param], stack


def test_a_stack_is_taken_in_any_form(given):
    value, stack = given
    assert lamina.solve(value, "preview").stack == stack
    assert lamina.bake(value, "preview", row_stride=32).header["stack_hash"] == stack.hash
    assert lamina.estimate(value, 0.5, 0.6, samples=4096).value == pytest.approx(
        lamina.estimate(stack, 0.5, 0.6, samples=4096).value, abs=0.0)


@pytest.mark.parametrize("call", [lamina.searchlight, lamina.subsurface_nodes], ids=lambda call: call.__name__)
def test_preset_ids_where_lengths_are_needed(call):
    assert repr(call(MARBLE, quality="preview")) == repr(call(lamina.presets.load(MARBLE), quality="preview"))


@pytest.mark.parametrize("wrong", ["no-such-preset", "stack.txt", 3, None])
def test_anything_else_is_refused_in_a_sentence(wrong):
    with pytest.raises(ArgumentError, match="stack = .*: must be a lamina.Stack, the id of a preset"):
        lamina.solve(wrong)


def test_a_misspelt_preset_has_suggestions():
    with pytest.raises(ArgumentError, match="similar presets are lacquered-copper"):
        lamina.solve("lacqured-copper")
    with pytest.raises(ArgumentError) as caught:
        lamina.solve("qqq")
    assert "similar" not in str(caught.value)


def test_preset_ids_where_stacks_are_saved_and_exported(tmp_path, monkeypatch):
    monkeypatch.setenv("LAMINA_PRESETS", str(tmp_path / "mine"))
    assert lamina.Stack.load(lamina.presets.save(PRESET, "my soot")) == lamina.presets.load(PRESET)
    files = [tmp_path / name for name in ("id.bsdf", "solved.bsdf")]
    for file, given in zip(files, (PRESET, lamina.solve(PRESET)), strict=True):
        lamina.rgl.save_bsdf(given, file, size=8, angles=4)
    assert files[0].read_bytes() == files[1].read_bytes()


def test_a_file_in_place_of_the_folder_of_presets_is_named(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv("LAMINA_PRESETS", str(tmp_path / "file"))
    assert lamina.presets.user_names() == []
    with pytest.raises(NotADirectoryError, match="must be a folder, for the user's presets") as caught:
        lamina.presets.save(PRESET, "mine")
    assert caught.value.filename == str(tmp_path / "file")


def test_a_missing_file_is_named():
    with pytest.raises(FileNotFoundError, match="missing.json"):
        lamina.solve("missing.json")


def test_results_are_short_to_print():
    solved = lamina.solve(PRESET, "preview")
    lut, beam = lamina.bake(PRESET, "preview", row_stride=32), lamina.searchlight(MARBLE, quality="preview")
    for result in (solved, lut, beam):
        text = repr(result)
        assert text.startswith(f"<{type(result).__name__}") and len(text) < 160 and "\n" not in text
    assert "Soot on brick" in repr(solved)
    assert "1 layers on nothing" in repr(lamina.solve(lamina.Stack([lamina.Medium(albedo=0.5, tau=1.0)]), "preview"))


def same(a, b):
    return np.array_equal(a.brdf(0.6, [0.3, 0.9], 1.0), b.brdf(0.6, [0.3, 0.9], 1.0))


def test_results_can_be_pickled():
    solved = lamina.solve(PRESET, "preview")
    for function in (solved, solved.with_thickness(0, [0.1, 0.2, 0.3]), solved.with_base_reflectance(0.2)):
        assert same(pickle.loads(pickle.dumps(function)), function)
    assert not same(solved, solved.with_base_reflectance(0.2))
    beam = lamina.searchlight(MARBLE, mu_i=0.7, quality="preview")
    loaded = pickle.loads(pickle.dumps(beam))
    assert np.array_equal(loaded.reflected_inside([1.0, 3.0]), beam.reflected_inside([1.0, 3.0]))
    lut = lamina.bake(PRESET, "preview", row_stride=32)
    again = pickle.loads(pickle.dumps(lut))
    assert again.header == lut.header and np.array_equal(again.weights, lut.weights)
    stack = lamina.presets.load(PRESET)
    assert pickle.loads(pickle.dumps(stack)) == stack and hash(stack) == hash(lamina.presets.load(PRESET))


def test_the_command_line_takes_preset_ids_and_refuses_wrong_suffixes(tmp_path, capfd):
    assert cli.main(["bake", PRESET, "-o", str(tmp_path / "soot.npz"), "--quality", "preview", "--quiet"]) == 0
    assert lamina.Lut.load(tmp_path / "soot.npz").header["stack_hash"] == lamina.presets.load(PRESET).hash
    assert cli.main(["bake", PRESET, "-o", str(tmp_path / "soot.exr")]) == 2
    assert "must end in .npz" in capfd.readouterr().err and not (tmp_path / "soot.exr").exists()


def test_without_arguments_the_command_line_prints_help(capfd):
    assert cli.main([]) == 0
    assert "usage:" in capfd.readouterr().out
