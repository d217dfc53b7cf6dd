# SPDX-License-Identifier: GPL-3.0-or-later
"""The lookup table as a file: it is read back unchanged, and no other file is accepted."""

import io
import json
import os
import pickle
import random
import zipfile

import numpy as np
import pytest

import lamina
from lamina import HenyeyGreenstein, Lambert, Lut, LutError, Medium, Stack
from lamina.closures.axes import column_angles, tau_rows

STACK = Stack([Medium(albedo=[0.9, 0.8, 0.6], tau=1.0, phase=HenyeyGreenstein(0.6))], base=Lambert([0.5, 0.3, 0.1]))


@pytest.fixture(scope="module")
def lut():
    return lamina.bake(STACK, "preview")


@pytest.fixture
def saved(lut, tmp_path):
    path = tmp_path / "lut.npz"
    lut.save(path)
    return path


def refused(path, content):
    path.write_bytes(content)
    with pytest.raises(LutError) as caught:
        Lut.load(path)
    sentence = str(caught.value)
    assert sentence.startswith(f"{path}: ") and "\n" not in sentence
    return sentence


def npz(header, weights):
    """A file like ours with any content."""
    file = io.BytesIO()
    np.savez(file, header=np.frombuffer(json.dumps(header).encode(), np.uint8), weights=weights)
    return file.getvalue()


def test_round_trip(lut, saved):
    again = Lut.load(saved)
    assert again.header == lut.header and again.weights.dtype == np.float32
    assert again.weights.tobytes() == lut.weights.tobytes()
    assert {k: v for k, v in again.report.items() if k != "seconds"} == lut.header["report"]
    assert os.listdir(saved.parent) == ["lut.npz"]


def test_equal_tables_are_equal_bytes(lut, saved, tmp_path):
    Lut.load(saved).save(tmp_path / "again.npz")
    assert (tmp_path / "again.npz").read_bytes() == saved.read_bytes()


@pytest.mark.parametrize("share", [0.0, 0.001, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.9999])
def test_a_truncated_file_is_refused(saved, share):
    content = saved.read_bytes()
    assert "not a complete Lamina lookup table" in refused(saved, content[: int(share * len(content))])


def test_every_damaged_byte_is_noticed_or_harmless(lut, saved):
    """Never another exception, never other numbers."""
    content, path = saved.read_bytes(), saved.with_name("damaged.npz")
    generator = random.Random(1)
    places = [*range(80), *range(len(content) - 250, len(content)), *generator.sample(range(len(content)), 150)]
    for place in places:
        for bit in (1, 64, 128):
            damaged = bytearray(content)
            damaged[place] ^= bit
            path.write_bytes(damaged)
            try:
                again = Lut.load(path)
            except LutError:
                continue
            assert again.header == lut.header and again.weights.tobytes() == lut.weights.tobytes(), (place, bit)


def test_foreign_files_are_refused(saved, lut):
    text = io.BytesIO()
    with zipfile.ZipFile(text, "w") as archive:
        archive.writestr("readme.txt", "hello")
    plain = io.BytesIO()
    np.save(plain, np.zeros(3))
    compressed = io.BytesIO()
    np.savez_compressed(compressed, header=np.zeros(999, np.uint8), weights=lut.weights)
    broken = bytearray(compressed.getvalue())
    broken[150:190] = b"\xff" * 40
    for content in (b"hello", b"\x89PNG\r\n", text.getvalue(), plain.getvalue(), bytes(broken),
                    npz([], lut.weights), npz("x", lut.weights), npz({"schema": "1"}, lut.weights),
                    npz({"schema": 1}, lut.weights)):
        refused(saved, content)


def test_pickles_are_refused_and_not_run(saved):
    class Trap:
        def __reduce__(self):
            return (os.mkdir, (str(saved.parent / "sprung"),))

    refused(saved, pickle.dumps(Trap()))
    objects = io.BytesIO()
    np.savez(objects, header=np.array([Trap()], dtype=object), weights=np.array([Trap()], dtype=object))
    refused(saved, objects.getvalue())
    assert not (saved.parent / "sprung").exists()


def test_a_newer_schema_is_refused_by_its_number(saved, lut):
    sentence = refused(saved, npz({**lut.header, "schema": 3}, lut.weights))
    assert sentence == f"{saved}: schema 3 needs a newer Lamina, which reads up to 2"


@pytest.mark.parametrize("change", ["shape", "dtype", "negative", "nan", "closures"])
def test_weights_that_contradict_the_header_are_refused(saved, lut, change):
    header, weights = dict(lut.header), lut.weights.copy()
    if change == "shape":
        weights = weights[..., :2]
    elif change == "dtype":
        weights = weights.astype(np.float64)
    elif change == "closures":
        header["closures"] = header["closures"][:-1]
    else:
        weights[0, 0, 0, 0, 0] = -1.0 if change == "negative" else np.nan
    refused(saved, npz(header, weights))


@pytest.mark.parametrize("report", [{}, None, {"fit_error": "x"}], ids=["empty", "none", "partial"])
def test_an_incomplete_report_is_refused(saved, lut, report):
    assert "incomplete" in refused(saved, npz({**lut.header, "report": report}, lut.weights))


def test_a_missing_file_is_an_os_error(tmp_path):
    with pytest.raises(FileNotFoundError):
        Lut.load(tmp_path / "none.npz")


def test_a_failed_save_leaves_the_earlier_file(saved, lut, monkeypatch):
    before = saved.read_bytes()
    monkeypatch.setattr(os, "replace", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
    with pytest.raises(KeyboardInterrupt):
        lut.save(saved)
    assert saved.read_bytes() == before and os.listdir(saved.parent) == ["lut.npz"]


def test_layout(lut):
    sides, closures, rows, columns, channels = lut.weights.shape
    assert (sides, rows, columns, channels) == (1, 1, 64, 3)
    assert closures == len(lut.closures)
    assert lut.header["axes"]["view"]["count"] == 64
    assert lut.header["stack_hash"] == STACK.hash and lut.header["sides"] == ["top"]
    image = lut.image()
    assert image.shape == (closures, 64, 4) and image.dtype == np.float32 and np.all(image[..., 3] == 1.0)
    assert np.array_equal(image[2, :, :3], lut.weights[0, 2, 0])


def test_axes():
    angles = column_angles()
    assert angles.shape == (64,) and angles[0] == 0.0 and angles[63] == pytest.approx(np.pi / 2, rel=1e-15)
    assert np.diff(angles) == pytest.approx(np.full(63, np.pi / 2 / 63))
    rows = tau_rows(4.0)
    t = rows / (rows + 0.5)
    assert rows.shape == (33,) and rows[0] == 0.0 and rows[-1] == 4.0
    assert np.diff(t) == pytest.approx(np.full(32, 4.0 / 4.5 / 32))
