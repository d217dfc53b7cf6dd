# SPDX-License-Identifier: GPL-3.0-or-later
"""make bench: all benchmarks in turn, printed as tables and stored as JSON in build/bench.

    python bench/run.py [--quick] [NAME ...]      NAME: one of BENCHES

--quick: a second of each, to see that it runs; the numbers say little, and nothing is stored.
"""

import argparse
import importlib
import json
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
OUT = ROOT / "build/bench"
NATIVE = ROOT / "build/native-bench"


def in_this_process(module):
    return lambda **options: importlib.import_module(module).measure(**options)


def in_its_own(module):
    """Blender may hang when the interpreter exits. The file prints its own table if it stores no list of rows."""

    def measure(**options):
        words = [word for name, value in options.items() for word in (f"--{name}", str(value))]
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder, "rows.json")
            subprocess.run([sys.executable, ROOT / "bench" / f"{module}.py", "--out", out, *words], check=True)
            return json.loads(out.read_text(encoding="utf-8"))

    return measure


def native(program):
    """What a program of native/bench prints, a line of JSON for each row."""

    def measure(arguments=()):
        done = subprocess.run([NATIVE / program, *arguments], check=True, capture_output=True, text=True)
        return [json.loads(line) for line in done.stdout.splitlines() if line]

    return measure


# By name: (what measures, its options for --quick, title).
BENCHES = {
    "solver": (in_this_process("solver_bench"), {"repeats": 1, "streams": (32,)},
               "Slab solve, CPU time, against other codes (error: largest, mu >= .05)"),
    "doubling": (native("bench_doubling"), {"arguments": ["1"]},
                 "Doubling step against the rate of matrix products, one thread"),
    "walks": (in_this_process("walk_bench"), {"repeats": 1, "error": 0.05, "samples": 1 << 14},
              "Walks on the standard slab to .1 % standard error, wall clock, 2 threads, against Mitsuba"),
    "searchlight": (in_this_process("searchlight_bench"), {"photons": 1 << 16, "stacks": 1},
                    "Searchlight against photons at equal error in rings, CPU time of one thread"),
    "inverse": (in_this_process("inverse_bench"), {"cases": 2, "repeats": 1},
                "Fits to measurements, wall clock, all threads, against SciPy over lamina.solve"),
    "bake": (in_this_process("bake_bench"), {"repeats": 1, "stacks": 1}, "Bake, wall clock, all threads"),
    "fit": (in_this_process("fit_bench"), {"qualities": ("preview",), "bases": ("standard",), "stacks": 3},
            "Closure fit, relative L2 errors of the slices"),
    "update": (in_its_own("update_bench"), {"repeats": 2},
             "Updates, wall clock from a changed property to updated pixels (limit 33 ms)"),
    "dust": (in_this_process("dust_bench"), {"points": 1000, "around": 66},
             "Dust: rays of settling against a bare loop of Embree's, wall clock"),
    "interior": (native("bench_mesh_walk"), {"arguments": ["1", "1"]},
                 "Walks in a mesh of 100 k faces with 256^3 voxels, CPU time of all threads (limit 1 M/s)"),
    "voxels": (in_this_process("interior_bench"), {"repeats": 1, "paths": 1 << 10, "samples": 4},
               "Walks in voxels to 1 % of a texel, wall clock, 2 threads, against Mitsuba on the same grid"),
    "frames": (in_its_own("frames_bench"), {"size": 8},
               "Frames until a baked interior is cheaper than Cycles' volume, CPU time at 1 % noise"),
    "portal": (in_its_own("portal_bench"), {"samples": 16, "repeats": 2, "cases": 1},
               "The portal beside Cycles' Random Walk on a sphere under a sun, CPU time"),
    "render": (in_its_own("render_bench"), {"size": 16, "repeats": 1, "quality": "preview"}, "Rendering in Cycles"),
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


def main(argv):
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(BENCHES))
    parser.add_argument("--quick", action="store_true", help="a second of each; nothing is stored")
    arguments = parser.parse_args(argv)
    unknown = [name for name in arguments.names if name not in BENCHES]
    if unknown:
        print(f"bench: {unknown[0]}: must be one of {', '.join(BENCHES)}", file=sys.stderr)
        return 2
    for name in arguments.names or BENCHES:
        measure, quick, title = BENCHES[name]
        print(f"\n{title}", flush=True)
        rows = measure(**(quick if arguments.quick else {}))
        if isinstance(rows, list):
            print(table(rows), flush=True)
        if not arguments.quick:
            OUT.mkdir(parents=True, exist_ok=True)
            (OUT / f"{name}.json").write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
