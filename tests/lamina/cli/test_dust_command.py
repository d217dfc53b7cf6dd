# SPDX-License-Identifier: GPL-3.0-or-later
"""python -m lamina dust: from a mesh file to arrays, with one sentence for errors."""

import argparse
from dataclasses import replace

import numpy as np
import pytest
from needs_embree import with_embree

from lamina import dust
from lamina.cli import dust_command, main
from lamina.common.archive import load_archive
from lamina.kinds.dust import OPTIONS

PLY = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
1 0 -1
0 0 -1
4 3 2 1 0
"""


@pytest.fixture
def plate(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plate.ply").write_text(PLY)
    return "plate.ply"


@with_embree
def test_arrays_and_statistics(plate, capsys):
    words = ["dust", plate, "-o", "out.npz", "--amount", "2", "--up", "y", "--rays", "16", "--threads", "1"]
    assert main([*words, "--two-sided"]) == 0
    assert "optical thickness 2 on average" in capsys.readouterr().out
    header, arrays = load_archive("out.npz", "tau", "arrived")
    np.testing.assert_allclose(arrays[0], 2.0, rtol=1e-6)
    assert header["statistics"]["points"] == 4
    assert dust.Settling(**header["settings"]).tau == 2.0


@with_embree
@pytest.mark.parametrize(("words", "sentence", "code"), [
    (["--spread", "95"], "--spread 95: must lie in [0, 85.94] degrees", 2),
    (["--repose", "200"], "--repose 200: must lie in [0, 180] degrees", 2),
    (["--sharp", "nan"], "--sharp nan: must lie in [0, 180] degrees", 2),
    (["--amount", "1", "--grams", "1"], "not allowed with", 2),
    (["--occluder", "none.ply"], "none.ply: No such file", 1),
    (["--material", "flour", "--grams", "1"], "settling.extinction = 'flour'", 2),
    (["--up", "w"], "invalid choice", 2),
])
def test_bad_words(plate, capsys, words, sentence, code):
    try:
        left = main(["dust", plate, "-o", "out.npz", *words])
    except SystemExit as stop:
        left = stop.code
    assert left == code
    assert sentence in capsys.readouterr().err


def test_a_damaged_mesh(plate, tmp_path, capsys):
    (tmp_path / "bad.ply").write_text(PLY[:-30])
    assert main(["dust", "bad.ply", "-o", "out.npz"]) == 2
    assert capsys.readouterr().err == "lamina: bad.ply: ends too early\n"
    assert not (tmp_path / "out.npz").exists()


def test_an_option_without_a_usual_value_can_be_a_flag():
    parser = argparse.ArgumentParser()
    patch = next(option for option in OPTIONS if option.name == "patch")
    dust_command._add_flag(parser, replace(patch, help="size of patches"))
    assert parser.parse_args([]).patch is None
    assert parser.parse_args(["--patch", "2"]).patch == 2.0
