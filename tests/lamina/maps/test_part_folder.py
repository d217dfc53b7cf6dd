# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs that are killed, cancelled, or meet a full disk, continue at the missing parts and end with the same bytes."""

import json
import os
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest
from map_meshes import slab_with_uvs

import lamina
from lamina import EndMaterial, Interior
from lamina.common.progress import time_left
from lamina.interior.parts import WalkPart
from lamina.interior.problem import Samples
from lamina.maps import part_folder
from lamina.maps.part_folder import PartFolder, Pilot

SOLID, UVS = slab_with_uvs(0.5)
DARK = Interior.uniform(EndMaterial(0.5, 1.0))  # walks are short
HOW = {"uvs": UVS, "size": 8, "samples": 3_000, "seed": 5}

# Runs in a process of its own; `limit` is executed before the call. Prints a line for each progress report.
SCRIPT = """
    import sys
    sys.path[:0] = {paths!r}
    from test_part_folder import *
    {limit}
    try:
        lamina.relightable_images(SOLID, DARK, folder={folder!r}, progress=lambda _, text: print(text, flush=True),
                                  **HOW)
    except Exception as error:
        print(f"{{type(error).__name__}}: {{error}}", flush=True)
"""


def process(folder, limit=""):
    paths = [str(Path(__file__).parent), str(Path(__file__).parents[1])]
    script = textwrap.dedent(SCRIPT).format(paths=paths, folder=str(folder), limit=limit)
    return subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)


def bytes_of(found):
    return b"".join(array.tobytes() for array in (found.inputs.color, found.inputs.radius, found.mask,
                                                  found.estimate.albedo.stderr, found.estimate.mean_distance.value))


@pytest.fixture(scope="module")
def whole():
    return lamina.relightable_images(SOLID, DARK, threads=1, **HOW)


def test_killed_run_continues(tmp_path, whole):
    folder = tmp_path / "run"
    with process(folder) as running:
        while not running.stdout.readline().startswith("Part 4 of 6"):
            assert running.poll() is None
        running.kill()
    kept = {path: path.stat().st_mtime_ns for path in folder.glob("part-*.npz")}
    assert 3 <= len(kept) < 6
    said = []
    found = lamina.relightable_images(SOLID, DARK, folder=folder, progress=lambda _, text: said.append(text), **HOW)
    assert bytes_of(found) == bytes_of(whole)
    assert all(path.stat().st_mtime_ns == time for path, time in kept.items())
    assert "Part 1 of 6" not in said and not list(folder.glob(".*"))


def test_cancelled_run_continues(tmp_path, whole):
    said = []
    with pytest.raises(lamina.Cancelled):
        lamina.relightable_images(SOLID, DARK, folder=tmp_path, progress=lambda _, text: said.append(text),
                                  cancel=lambda: said and said[-1].startswith("Part 3 of 6"), **HOW)
    assert len(list(tmp_path.glob("part-*.npz"))) == 2
    assert bytes_of(lamina.relightable_images(SOLID, DARK, folder=tmp_path, **HOW)) == bytes_of(whole)


def test_another_run_ends_first_and_its_folder_is_removed(tmp_path, whole):
    """As where two batches compute the same light: the first one to end removes the parts of both."""
    folder, said = tmp_path / "run", []

    def progress(_, text):
        said.append(text)
        if text.startswith("Part 3 of 6") and folder.exists() and len(list(folder.glob("part-*.npz"))) == 2:
            shutil.rmtree(folder)

    found = lamina.relightable_images(SOLID, DARK, folder=folder, progress=progress, threads=1, **HOW)
    assert bytes_of(found) == bytes_of(whole) and len(list(folder.glob("part-*.npz"))) == 4


def test_damaged_parts_are_computed_again(tmp_path, whole):
    lamina.relightable_images(SOLID, DARK, folder=tmp_path, **HOW)
    first, second, third = sorted(tmp_path.glob("part-*.npz"))[:3]
    first.write_bytes(first.read_bytes()[:-50])
    flipped = bytearray(second.read_bytes())
    flipped[len(flipped) // 2] ^= 16
    second.write_bytes(flipped)
    third.write_bytes(b"")
    (tmp_path / "run.json").write_text("{")
    assert bytes_of(lamina.relightable_images(SOLID, DARK, folder=tmp_path, **HOW)) == bytes_of(whole)


def test_full_disk(tmp_path, whole):
    """A limit on the size of files stands for the full disk: run.json fits, a part does not."""
    limit = "import resource, signal; signal.signal(signal.SIGXFSZ, signal.SIG_IGN); " \
            "resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))"
    with process(tmp_path, limit) as running:
        last = running.stdout.readlines()[-1]
    assert last.startswith("OSError: ") and "0 finished parts are kept, and the same call continues" in last
    assert str(tmp_path) in last
    assert [path.name for path in tmp_path.iterdir()] == ["run.json"]
    assert bytes_of(lamina.relightable_images(SOLID, DARK, folder=tmp_path, **HOW)) == bytes_of(whole)


@pytest.mark.parametrize(("change", "key"), [({"seed": 6}, "seed"), ({"samples": 3_300}, "samples"),
                                             ({"size": 9}, "count"), ({"noise": 0.5, "samples": None}, "noise")])
def test_folder_of_another_run_is_refused(tmp_path, change, key):
    header = {"format": "lamina-run", "schema": 2, "samples": 3_000, "photons": 3_000}
    with pytest.raises(lamina.Cancelled):  # writes the request alone
        lamina.relightable_images(SOLID, DARK, folder=tmp_path, cancel=lambda: (tmp_path / "run.json").exists(), **HOW)
    assert header.items() <= json.loads((tmp_path / "run.json").read_text()).items()
    with pytest.raises(lamina.ShardError, match=f"holds the parts of another run, with a different {key}: choose"):
        lamina.relightable_images(SOLID, DARK, folder=tmp_path, **{**HOW, **change})
    assert os.listdir(tmp_path) == ["run.json"]


def test_number_of_walks_is_kept(tmp_path):
    """The trial that finds the number of walks is not repeated."""
    how = {**HOW, "samples": None, "noise": 0.05}
    first = lamina.relightable_images(SOLID, DARK, folder=tmp_path, **how)
    said = []
    again = lamina.relightable_images(SOLID, DARK, folder=tmp_path, progress=lambda _, text: said.append(text), **how)
    assert bytes_of(again) == bytes_of(first) and "Noise" not in said
    assert first.noise == pytest.approx(0.05, rel=0.1)
    np.testing.assert_array_equal(first.estimate.count.samples, again.estimate.count.samples)


def test_first_report_tells_the_time():
    """The trial that finds the number of walks also finds their time."""
    said = []
    lamina.relightable_images(SOLID, DARK, progress=lambda _, text: said.append(text),
                              **{**HOW, "samples": None, "noise": 0.02})
    first = next(text for text in said if text.startswith("Part 1 of"))
    assert first.endswith("left for a noise of 2 %")


def test_time_left(monkeypatch):
    """A pilot of 4 s for 10 of 1000 samples per point; then each part takes 50 s, half of what the pilot told."""
    count, clock, said = 4 * part_folder.SAMPLES_PER_PART // 1000, [0.0], []
    monkeypatch.setattr(part_folder.time, "perf_counter", lambda: clock[0])

    job = {"count": count, "samples": 1000}

    def compute(part, within):
        for half in (0.0, 0.5):
            within(half, "")
            clock[0] += 25.0
        return WalkPart(job, part[1], ())

    PartFolder(None, {}).run(compute, {Samples(1000): job}, lambda _, text: said.append(text), lambda _: None,
                             Pilot(4.0, 10.0, " for a noise of 2 %"))
    remaining = [1000 - 125 * half for half in range(8)]
    rates = [(4.0 + 25.0 * half) / (10.0 + 125.0 * half) for half in range(8)]
    assert said == [f"Part {half // 2 + 1} of 4, {time_left(rates[half] * remaining[half])} for a noise of 2 %"
                    for half in range(8)]
    assert said[0].startswith("Part 1 of 4, about 7 minutes left") and "left" in said[-1]
