# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of the user: saved, listed, loaded by name wherever a stack is taken, and deleted."""

import sys

import pytest

import lamina
from lamina import ArgumentError, Lambert, Medium, Stack, StackError, UnknownName, presets
from lamina.cli import main

STACK = Stack([Medium(0.9, 1.0)], Lambert(0.3), name="Matt")


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("LAMINA_PRESETS", str(tmp_path / "own" / "presets"))
    return tmp_path / "own" / "presets"


def test_a_preset_lives_from_save_to_delete(folder, capsys):
    assert presets.user_names() == [] and presets.user_folder() == folder
    assert presets.save(STACK, "  my   matt ") == folder / "my matt.json"
    presets.save(STACK, "Another")
    assert presets.user_names() == ["Another", "my matt"]
    assert presets.load_user("my matt") == STACK and Stack.load(folder / "my matt.json") == STACK
    assert lamina.solve("my matt", "preview").stack == STACK
    assert main(["presets"]) == 0 and "my matt" in capsys.readouterr().out
    assert main(["presets", "my matt"]) == 0 and '"Matt"' in capsys.readouterr().out
    presets.delete("my matt")
    assert presets.user_names() == ["Another"]
    with pytest.raises(ArgumentError, match="stack = 'my matt': must be"):
        lamina.solve("my matt")


def test_a_taken_name_is_replaced_on_request_only(folder):
    presets.save(STACK, "Matt")
    other = Stack([], Lambert(0.5))
    with pytest.raises(StackError, match=r"^name = matt: there is a preset of this name; choose another, or set"):
        presets.save(other, "matt")
    assert presets.load_user("Matt") == STACK
    presets.save(other, "matt", replace=True)
    assert presets.user_names() == ["Matt"] and presets.load_user("Matt") == other
    assert [path.name for path in folder.iterdir()] == ["Matt.json"]


@pytest.mark.parametrize("name", ["", " ", "a/b", "..", "con", "x" * 61, "a\nb\0", "../up", 3, "gold", "Gold"])
def test_bad_names_leave_nothing(name, folder):
    with pytest.raises(StackError, match="^name "):
        presets.save(STACK, name)
    assert not folder.exists()


def test_what_is_not_there():
    for call in (presets.load_user, presets.delete):
        with pytest.raises(UnknownName, match="^preset = 'nothing': (unknown|you have no)"):
            call("nothing")
    with pytest.raises(ArgumentError, match="^stack = 3: must be a lamina.Stack"):
        presets.save(3, "name")


def test_the_usual_folder(monkeypatch, tmp_path):
    monkeypatch.delenv("LAMINA_PRESETS")
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.setattr(sys, "platform", "linux")
    assert presets.user_folder() == tmp_path / "lamina" / "presets"
