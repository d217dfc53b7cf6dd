# SPDX-License-Identifier: GPL-3.0-or-later
"""The order of the demo scenes, and the time of each announcement."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "demo_scenes"))
import make_demo


@pytest.fixture
def rendered(monkeypatch, capsys):
    """Scenes that render nothing; the names of those that ran, each with the output printed before it began."""
    ran = []

    def make(names, *_arguments):
        for name in names:
            ran.append((name, capsys.readouterr().out))
            yield [make_demo.HERE / "out" / f"{name}.png"], "agree", True

    monkeypatch.setattr(make_demo, "make", make)
    return ran


def test_the_slab_is_first_and_each_scene_is_announced_before_the_next_begins(rendered):
    assert make_demo.main([]) == 0
    names = [name for name, _ in rendered]
    assert names[0] == "slab" and names == make_demo.scenes() and len(names) > 4
    for (before, _), (_, printed) in zip(rendered, rendered[1:], strict=False):
        assert f"{before}.png: agree" in printed


def test_scenes_can_be_left_out(rendered):
    assert make_demo.main(["all", "--except", "slab"]) == 0
    assert [name for name, _ in rendered] == make_demo.scenes()[1:]
