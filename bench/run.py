# SPDX-License-Identifier: GPL-3.0-or-later
"""make bench: all benchmarks in turn, printed as tables and stored as JSON in build/bench.

    python bench/run.py [solver|doubling|walks|searchlight|bake|fit|live|dust|interior|voxels|frames|portal|render ...]
"""

import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
OUT = ROOT / "build/bench"
NATIVE = ROOT / "build/native-bench/native/bench"


def solver():
    import solver_bench

    return solver_bench.measure()


def doubling():
    return _rows_of("bench_doubling")


def _rows_of(program):
    """What a program of native/bench prints, a line of JSON for each row."""
    done = subprocess.run([NATIVE / program], check=True, capture_output=True, text=True)
    return [json.loads(line) for line in done.stdout.splitlines() if line]


def walks():
    import walk_bench

    return walk_bench.measure()


def searchlight():
    import searchlight_bench

    return searchlight_bench.measure()


def bake():
    import bake_bench

    return bake_bench.measure()


def fit():
    import fit_bench

    return fit_bench.measure()


def live():
    import live_bench

    return live_bench.measure()


def dust():
    import dust_bench

    return dust_bench.measure()


def interior():
    return _rows_of("bench_mesh_walk")


def voxels():
    import interior_bench

    return interior_bench.measure()


def frames():
    # In a process of its own, like `render`.
    subprocess.run([sys.executable, ROOT / "bench/frames_bench.py"], check=True)
    return json.loads((OUT / "frames.json").read_text(encoding="utf-8"))


def portal():
    # In a process of its own, like `render`.
    subprocess.run([sys.executable, ROOT / "bench/portal_bench.py"], check=True)
    return json.loads((OUT / "portal.json").read_text(encoding="utf-8"))


def render():
    # bpy may hang when the interpreter exits, so this runs in a process of its own.
    subprocess.run([sys.executable, ROOT / "bench/render_bench.py"], check=True)
    return None


BENCHES = {
    "solver": (solver, "Slab solve, CPU time, against other codes (error: largest, mu >= .05)"),
    "doubling": (doubling, "Doubling step against the rate of matrix products, one thread"),
    "walks": (walks, "Walks on the standard slab to .1 % standard error, wall clock, 2 threads, against Mitsuba"),
    "searchlight": (searchlight, "Searchlight against photons at equal error in rings, CPU time of one thread"),
    "bake": (bake, "Bake, wall clock, all threads"),
    "fit": (fit, "Closure fit, relative L2 errors of the slices"),
    "live": (live, "Live editing, wall clock from a changed property to updated pixels (limit 33 ms)"),
    "dust": (dust, "Dust: rays of settling against a bare loop of Embree's, wall clock"),
    "interior": (interior, "Walks in a mesh of 100 k faces with 256^3 voxels, CPU time of all threads (limit 1 M/s)"),
    "voxels": (voxels, "Walks in voxels to 1 % of a texel, wall clock, 2 threads, against Mitsuba on the same grid"),
    "frames": (frames, "Frames until a baked interior is cheaper than Cycles' volume, CPU time at 1 % noise"),
    "portal": (portal, "The portal beside Cycles' Random Walk on a sphere under a sun, CPU time"),
    "render": (render, "Rendering in Cycles"),
}


def table(rows):
    """Rows of dicts as text columns; keys of the first row that has them, in order."""
    keys = list(dict.fromkeys(key for row in rows for key in row))
    cells = [keys] + [[_cell(row.get(key, "")) for key in keys] for row in rows]
    widths = [max(len(line[k]) for line in cells) for k in range(len(keys))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip()
                     for line in cells)


def _cell(value):
    if isinstance(value, float):
        return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"
    return "-" if value is None else str(value)


def main(names):
    unknown = [name for name in names if name not in BENCHES]
    if unknown:
        print(f"bench: {unknown[0]}: must be one of {', '.join(BENCHES)}", file=sys.stderr)
        return 2
    OUT.mkdir(parents=True, exist_ok=True)
    for name in names or BENCHES:
        work, title = BENCHES[name]
        print(f"\n{title}", flush=True)
        rows = work()
        if rows is not None:
            (OUT / f"{name}.json").write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
            print(table(rows), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
