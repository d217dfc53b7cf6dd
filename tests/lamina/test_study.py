# SPDX-License-Identifier: GPL-3.0-or-later
"""The study's harness on two cells and one stack: complete outputs, plausible scores, pictures of the data."""

import math
import subprocess
import sys
from pathlib import Path

import pytest
from z_limit import z_limit

from lamina import _core

STUDY = Path(__file__).parents[2] / "study"
sys.path.insert(0, str(STUDY))

import grid  # noqa: E402
import measure  # noqa: E402
import plots  # noqa: E402
import tables  # noqa: E402
from walks import BASELINE, ISOTROPIC, METHODS, UNTABLED, chosen  # noqa: E402


def run(out):
    subprocess.run([sys.executable, STUDY / "run.py", "--quick", "--out", out, "--jobs", "1"], check=True,
                   capture_output=True)


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    run(folder)
    return folder


@pytest.fixture(scope="module")
def rows(out):
    return tables.read("grid", out / "study")


def test_the_grid_is_whole():
    cells = grid.cells()
    assert len(cells) == len({(cell.slab, cell.directions) for cell in cells}) == 4 * 7 * 3 * 5
    assert len(grid.quick()) == 2 and set(grid.quick()) <= set(cells)


def test_every_cell_has_every_method(rows):
    for cell in grid.quick():
        inside = [row for row in rows if cell.columns().items() <= row.items()]
        assert {row["method"] for row in inside} == set(METHODS) - ({ISOTROPIC} if cell.slab.g else set())
        for row in inside:
            assert row["samples"] == measure.BATCHES * _core.WALK_BLOCK
            assert row["variance"] > 0 and row["cpu_us"] > 0 and row["ratio"] > 0 and row["time_ratio"] > 0


def test_scores(out, rows):
    """Walks with a variance to rely on, by Z-score; 1 % for the family."""
    more = [*tables.read("layers", out / "study"), *tables.read("lateral", out / "study")]
    scores = [row["z"] for row in (*rows, *more) if row["status"] == "ok"]
    assert len(scores) >= 16 and all(abs(z) < z_limit(len(scores)) for z in scores)


def test_guided_walks_gain(rows):
    """By variance alone, which no clock disturbs."""
    for cell in grid.quick():
        variance = {row["method"]: row["variance"] for row in rows if cell.columns().items() <= row.items()}
        assert variance[chosen(cell.slab.g)] < 0.1 * variance[BASELINE]


@pytest.mark.parametrize("column, methods", [("ratio", plots.BETTER), ("time_ratio", plots.BETTER),
                                             ("ratio", (UNTABLED,))])
def test_pictures_show_all_data(rows, column, methods):
    figure = plots.draw_grid(rows, column, methods, "")
    drawn = sorted(float(line.get_ydata()[0]) for panel in figure.axes for line in panel.lines
                   if line.get_gid() == "cell")
    assert drawn == sorted(row[column] for row in rows if row["method"] in methods)


def test_the_picture_of_layers_shows_all_data(out):
    rows = tables.read("layers", out / "study")
    figure = plots.draw_layers(rows)
    drawn = sorted(float(line.get_xdata()[0]) for line in figure.axes[0].lines if line.get_gid() == "cell")
    assert drawn == sorted(row["ratio"] for row in rows if row["method"] != BASELINE)


def test_both_walks_of_a_beam_are_measured(out):
    rows = tables.read("lateral", out / "study")
    assert {row["method"] for row in rows} == {"transfer", "scattering"} and len(rows) == 8
    assert all(row["variance"] > 0 and row["cpu_us"] > 0 and row["ratio"] > 0 for row in rows)
    assert all(row["ratio"] == 1 for row in rows if row["method"] == "transfer")
    assert "| half-space, albedo .5 | scattering |" in (out / "study-3d.md").read_text(encoding="utf-8")


def test_pictures_and_tables_are_written(out):
    for name in ("study-grid", "study-time", "study-plain", "study-cost", "study-layers"):
        assert (out / f"{name}.png").stat().st_size > 10_000
    text = (out / "study.md").read_text(encoding="utf-8")
    for part in text.split("<!-- table:")[1:]:
        assert part.startswith("hard -->") or "\n|" in part.split("<!-- end -->")[0] or "No cell" in part


def test_what_is_measured_is_not_measured_again(out):
    before = {path: path.stat().st_mtime_ns for path in (out / "work").rglob("*.json")}
    table = (out / "study/grid.csv").read_bytes()
    run(out)
    assert before == {path: path.stat().st_mtime_ns for path in (out / "work").rglob("*.json")}
    assert table == (out / "study/grid.csv").read_bytes()


def test_variance_and_its_error():
    """Batches of known samples: 1, 3 and 2, 2 about an exact 2."""
    found = measure.evaluate([(4.0, 10.0, 3.0, 2, 2), (4.0, 8.0, 2.0, 2, 4)], [2e-6, 4e-6], 2.0, 0.0)
    assert found["variance"] == pytest.approx(0.5 / 4.0)
    assert found["variance_error"] == pytest.approx(math.sqrt(0.5) / 4.0 / math.sqrt(2.0))
    assert found["cpu_us"] == pytest.approx(1.5) and found["events"] == 1.5 and found["z"] == 0.0
    assert found["status"] == "variance not reliable" and found["largest_share"] == 0.5


@pytest.mark.parametrize("arguments, words", [
    (["nothing"], "nothing: must be one of grid, layers, lateral, hard, show"),
    (["--quick"], "--quick needs --out"),
    (["--jobs", "0"], "--jobs 0: must be at least 1"),
])
def test_bad_calls(arguments, words):
    done = subprocess.run([sys.executable, STUDY / "run.py", *arguments], capture_output=True, text=True)
    assert done.returncode == 2 and words in done.stderr and "Traceback" not in done.stderr
