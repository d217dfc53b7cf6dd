# SPDX-License-Identifier: GPL-3.0-or-later
"""Damaged files of tables, stacks and meshes give one sentence each."""

import copy
import io
import json
import math
import zipfile

import pytest

import lamina
from lamina import Lambert, Lut, LutError, Medium, Stack

SHEET = Stack([Medium(albedo=0.5, tau=1.0)])


def member(name, shape, content, dtype="<f4", compression=zipfile.ZIP_STORED):
    """One .npy member of an archive with any header."""
    text = f"{{'descr': '{dtype}', 'fortran_order': False, 'shape': {shape}, }}".ljust(117).encode() + b"\n"
    return name, b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text + content, compression


def archive(*members):
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as made:
        for name, content, compression in members:
            made.writestr(f"{name}.npy", content, compression)
    return file.getvalue()


@pytest.mark.parametrize("shape", ["(1, 1, 10000000000, 64, 3)", f"({10**30},)", "(-1,)", f"({10**30}, 0)", "(2, 3"])
@pytest.mark.parametrize("which", ["header", "weights"])
def test_an_archive_that_claims_too_much_is_refused_by_its_size(tmp_path, shape, which):
    path = tmp_path / "big.npz"
    content = {"header": member("header", "(2,)", b"{}", "|u1"), "weights": member("weights", "(0,)", b"")}
    content[which] = member(which, shape, b"", "<f4")
    path.write_bytes(archive(*content.values()))
    assert path.stat().st_size < 700
    with pytest.raises(LutError, match="not a complete Lamina lookup table"):
        Lut.load(path)


def test_a_packed_archive_is_refused(tmp_path):
    path = tmp_path / "bomb.npz"
    path.write_bytes(archive(member("header", "(2,)", b"{}", "|u1"),
                             member("weights", "(1000000,)", bytes(4000000), compression=zipfile.ZIP_DEFLATED)))
    with pytest.raises(LutError, match="not a complete Lamina lookup table"):
        Lut.load(path)


def damaged(member_of_weights):
    return archive(member("header", "(2,)", b"{}", "|u1"), member_of_weights)


REASONS = {
    "foreign": (b"hello", "no .npz archive"),
    "truncated": (archive(member("header", "(2,)", b"{}", "|u1"))[:-30], "the archive is truncated or damaged"),
    "no weights": (archive(member("header", "(2,)", b"{}", "|u1")), "it has no array 'weights'"),
    "no header": (archive(member("weights", "(0,)", b"")), "it has no array 'header'"),
    "bad header": (archive(member("header", "(2,)", b"{]", "|u1"), member("weights", "(0,)", b"")),
                   "its header is not valid JSON, Expecting"),
    "packed": (damaged(member("weights", "(1000,)", bytes(4000), compression=zipfile.ZIP_DEFLATED)),
               "its array 'weights' is compressed"),
    "objects": (damaged(member("weights", "(1,)", bytes(8), "|O")), "its array 'weights' holds Python objects"),
    "shape": (damaged(member("weights", "(3,)", bytes(4))),
              "its array 'weights' has 4 bytes, which do not fit the shape"),
    "literal": (damaged(member("weights", "(2, 3", b"")), "its array 'weights' has no description that NumPy reads"),
}


@pytest.mark.parametrize("name", REASONS)
def test_a_damaged_table_names_what_is_wrong(tmp_path, name):
    content, reason = REASONS[name]
    path = tmp_path / "bad.npz"
    path.write_bytes(content)
    with pytest.raises(LutError) as caught:
        Lut.load(path)
    assert str(caught.value).startswith(f"{path}: not a complete Lamina lookup table: {reason}")


HEADER = """ply
format ascii 1.0
element vertex {}
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
3 0 1 2
"""


def test_a_byte_order_mark_is_read_over(tmp_path):
    stack, mesh = tmp_path / "stack.json", tmp_path / "mesh.ply"
    stack.write_text("\ufeff" + json.dumps(SHEET.to_json()), encoding="utf-8")
    assert Stack.load(stack) == SHEET
    mesh.write_text("\ufeff" + HEADER.format(3), encoding="utf-8")
    assert len(lamina.ply.load(mesh).vertices) == 3


def test_huge_numbers_in_files(tmp_path):
    stack, mesh = tmp_path / "stack.json", tmp_path / "mesh.ply"
    stack.write_text('{"schema": 1' + "0" * 5000 + "}")
    with pytest.raises(lamina.StackError, match=r"a number has 5001 digits: must have at most 1000"):
        Stack.load(stack)
    for count in ("4000000000", "9" * 5000):
        mesh.write_text(HEADER.format(count))
        with pytest.raises(lamina.common.errors.MeshFileError, match="elements 'vertex': must have at most 1073741824"):
            lamina.ply.load(mesh)


@pytest.fixture(scope="module")
def lut():
    varying = Stack([Medium(albedo=0.9, tau=1.0, varying=True)], Lambert(0.5, textured=True))
    return lamina.bake(varying, "final", nodes=8, row_stride=16)


INCOMPLETE = "the header of the lookup table is incomplete"
WRONG = {
    "schema -1": (["schema"], -1, "schema = -1: must be 1"),
    "schema 0": (["schema"], 0, "schema = 0: must be 1"),
    "schema true": (["schema"], True, "not a Lamina lookup table"),
    "closure": (["closures", 0], "velvet", "closure 'velvet': this version of Lamina does not know it"),
    "closure a number": (["closures", 0], 5, "closure 5: this version"),
    "closure nan": (["closures", 0], "ggx:nan", "closure 'ggx:nan': this version"),
    "mirror": (["closures", 0], "mirror:2", "closure 'mirror:2': this version"),
    "long closure": (["closures", 0], "x" * 9999, "closure 'xxx"),
    "sides": (["sides"], ["bottom"], "sides = ['bottom']: must be"),
    "report": (["report", "fit_error"], "x", "report.fit_error = 'x': must be a number from 0"),
    "report nan": (["report", "albedo_error"], math.nan, "report.albedo_error = nan: must be a number from 0"),
    "worst": (["report", "worst_slice", "mu_o"], 2.0, "report.worst_slice.mu_o = 2.0: must be a cosine"),
    "solver": (["report", "solver"], None, f"{INCOMPLETE}: report.solver.nodes is missing"),
    "rows": (["report", "row_errors"], {"tau": []}, f"{INCOMPLETE}: report.row_errors.mean is missing"),
    "no rows": (["report", "row_errors"], None, f"{INCOMPLETE}: report.row_errors.tau is missing"),
    "few rows": (["report", "row_errors", "worst"], [0.1], "report.row_errors.worst has 1 entries: must have one for"),
    "report a number": (["report"], 5, f"{INCOMPLETE}: report.fit_error is missing"),
    "worst a number": (["report", "worst_slice"], 5, f"{INCOMPLETE}: report.worst_slice.error is missing"),
    "view": (["axes", "view", "count"], 63, "axes.view.count = 63: must be 64"),
    "values": (["axes", "tau", "values"], [1.0], "axes.tau.values has 1 entries: axes.tau.count says 33"),
    "falling": (["axes", "tau", "values", 0], 9.0, "axes.tau.values = [9.0, "),
    "huge": (["axes", "tau", "count"], 10**15, "axes.tau.values has 33 entries: axes.tau.count says 1000000000000000"),
    "base": (["stack", "base"], None, "stack.base.reflectance: must be 1 or 3 numbers"),
}


@pytest.mark.parametrize(("place", "value", "words"), WRONG.values(), ids=WRONG)
def test_a_header_that_does_not_hold_together_is_refused(lut, tmp_path, place, value, words):
    header = copy.deepcopy(lut.header)
    inside = header
    for key in place[:-1]:
        inside = inside[key]
    inside[place[-1]] = value
    Lut(lut.header, lut.weights).save(tmp_path / "good.npz")
    assert Lut.load(tmp_path / "good.npz").header == lut.header
    Lut(header, lut.weights).save(tmp_path / "bad.npz")
    with pytest.raises(LutError) as caught:
        Lut.load(tmp_path / "bad.npz")
    assert "\n" not in str(caught.value) and len(str(caught.value)) < 400
    assert str(caught.value).removeprefix(f"{tmp_path / 'bad.npz'}: ").startswith(words)
