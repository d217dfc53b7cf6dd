# SPDX-License-Identifier: GPL-3.0-or-later
"""make study: measures every cell, and makes pictures and tables of the measurements.

    python study/run.py [grid|layers|lateral|hard|show ...] [--quick] [--out FOLDER] [--jobs N]

Without a name: grid, layers, lateral and show. Measurements are stored in build/study, and an interrupted run continues
with the missing ones. `--quick` measures two cells and one stack."""

import argparse
import json
import multiprocessing
import shutil
import sys
import time
from pathlib import Path

import grid
import hard
import lateral
import layers
import measure
import tables

ROOT = Path(__file__).resolve().parent.parent
PARTS = ("grid", "layers", "lateral", "hard", "show")
QUICK_SECONDS = 0.0  # always the least number of samples


def _cell(task):
    cell, seconds = task
    return measure.measure(cell, seconds)


def _stack(task):
    name, seconds = task
    return layers.measure(name, seconds)


def _beam(task):
    name, seconds = task
    return lateral.measure(name, seconds)


def kept(work: Path, name: str, tasks: dict, function, seconds: float, jobs: int) -> list[dict]:
    """Rows of all tasks, in their order; measurements of this build of the core are read, not repeated."""
    folder = work / f"{name}-{hard.core_hash()}-{seconds}"
    folder.mkdir(parents=True, exist_ok=True)
    waiting = {key: (task, seconds) for key, task in tasks.items() if not (folder / f"{key}.json").exists()}
    started = time.perf_counter()
    # Start fresh processes: a fork would copy threads in an inconsistent state.
    with multiprocessing.get_context("spawn").Pool(min(jobs, max(1, len(waiting)))) as pool:
        for done, (key, rows) in enumerate(zip(waiting, pool.imap(function, waiting.values()), strict=True), 1):
            fresh = folder / f"{key}.new"
            fresh.write_text(json.dumps(rows), encoding="utf-8")
            fresh.replace(folder / f"{key}.json")
            if done % 20 == 0 or done == len(waiting):
                gone = time.perf_counter() - started
                print(f"{name}: {done} of {len(waiting)}, {gone:.0f} s, about "
                      f"{gone / done * (len(waiting) - done):.0f} s to go", flush=True)
    return [row for key in tasks for row in json.loads((folder / f"{key}.json").read_text(encoding="utf-8"))]


def main(arguments=None) -> int:
    parser = argparse.ArgumentParser(prog="study", description="Measures the walks against each other.")
    parser.add_argument("parts", nargs="*", metavar="PART", help=" | ".join(PARTS))
    parser.add_argument("--quick", action="store_true", help="two cells and one stack only")
    parser.add_argument("--out", type=Path, help="folder of data, pictures and text instead of docs")
    parser.add_argument("--jobs", type=int, default=2, help="processes side by side")
    given = parser.parse_args(arguments)
    unknown = [part for part in given.parts if part not in PARTS]
    if unknown:
        print(f"study: {unknown[0]}: must be one of {', '.join(PARTS)}", file=sys.stderr)
        return 2
    if given.jobs < 1:
        print(f"study: --jobs {given.jobs}: must be at least 1", file=sys.stderr)
        return 2
    if given.quick and given.out is None:
        print("study: --quick needs --out: it would overwrite the whole study", file=sys.stderr)
        return 2
    parts = given.parts or ["grid", "layers", "lateral", "show"]
    docs = given.out or ROOT / "docs"
    work = given.out / "work" if given.out else ROOT / "build/study"
    seconds = QUICK_SECONDS if given.quick else measure.SECONDS
    if "grid" in parts:
        cells = grid.quick() if given.quick else grid.cells()
        rows = kept(work, "cells", {f"{cell.number:03d}": cell for cell in cells}, _cell, seconds, given.jobs)
        tables.write("grid", rows, docs / "study")
    if "layers" in parts:
        names = list(layers.STACKS)[:1] if given.quick else list(layers.STACKS)
        rows = kept(work, "stacks", {name.replace(" ", "-"): name for name in names}, _stack, seconds, given.jobs)
        tables.write("layers", rows, docs / "study")
    if "lateral" in parts:
        names = list(lateral.STACKS)[:1] if given.quick else list(lateral.STACKS)
        rows = kept(work, "beams", {name.replace(" ", "-"): name for name in names}, _beam,
                    QUICK_SECONDS if given.quick else lateral.SECONDS, given.jobs)
        tables.write("lateral", rows, docs / "study")
    if "hard" in parts:
        tables.write("hard", hard.measure(), docs / "study")
    if "show" in parts:
        import plots
        import words

        if given.out:
            for page in words.PAGES:
                shutil.copyfile(ROOT / "docs" / page, docs / page)
        plots.draw_all(docs)
        words.write_tables(docs)
    return 0


if __name__ == "__main__":
    sys.exit(main())
