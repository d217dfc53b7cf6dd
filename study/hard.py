# SPDX-License-Identifier: GPL-3.0-or-later
"""1e8 samples of each walk on three hard cases against the solver, to test the walks for bias.

    python study/hard.py [case ...]

Takes about an hour of one thread. An interrupted run continues from its last completed part."""

import hashlib
import json
import math
import sys
import time
from pathlib import Path

import numpy as np
import tables
from walks import GUIDED, ISOTROPIC, Slab, make

from lamina import _core

ROOT = Path(__file__).resolve().parent.parent
WORK = ROOT / "build/study/hard"
SAMPLES = 10**8
SEED = 2000
PART = 512  # blocks that are summed separately and stored
NODES = (96, 192)  # number of nodes of the solver; the difference of both solutions is its error estimate

CASES = {
    "thick": (Slab(1.0, 50.0, 0.0), (0.5, 0.5, 1.0)),
    "peaked": (Slab(0.9, 1.0, 0.9), (1.0, 0.6, 0.0)),
    "grazing": (Slab(0.95, 1.0, 0.6), (0.05, 0.05, 0.5)),
}


def walks(slab, directions, pool):
    """(method, walk, error of its tables)."""
    for method in ("transfer", GUIDED, ISOTROPIC):
        made = make(method, slab, directions)
        if made is not None:
            yield method, made.walk, 0.0
    # A single layer would be read from its table: two halves make it a walk.
    walk, error = _core.adding_walk(slab.stack(2), _core.WalkTarget(*directions), pool)
    yield "adding", walk, error


def solved(slab, directions, nodes, pool):
    solution = _core.solve_at(slab.stack(), nodes, 1e-7, pool, slab.tau)
    arrays = (np.array([x]) for x in directions)
    return float(solution.points(_core.Side.top, _core.Path.reflect, *arrays, pool)[0])


def core_hash() -> str:
    """Identifies the build of the core: results of another build are not continued."""
    return hashlib.sha256(Path(_core.__file__).read_bytes()).hexdigest()[:16]


def run(path: Path, walk, samples: int, pool):
    """(sum, squares, largest, count, events, CPU seconds) of a run, stored in `path` part by part."""
    blocks = -(-samples // _core.WALK_BLOCK)
    job = {"core": core_hash(), "seed": SEED, "part": PART}
    parts = []
    if path.exists():
        kept = json.loads(path.read_text(encoding="utf-8"))
        if kept["job"] == job:
            parts = kept["parts"]
    count = -(-blocks // PART)
    for number in range(len(parts), count):
        started = time.process_time()
        tally = _core.run_walk(walk, SEED, number * PART, min((number + 1) * PART, blocks), pool)
        parts.append([*tally, time.process_time() - started])
        fresh = path.with_suffix(".new")
        fresh.write_text(json.dumps({"job": job, "parts": parts}), encoding="utf-8")
        fresh.replace(path)
    columns = list(zip(*parts[:count], strict=True))
    return math.fsum(columns[0]), math.fsum(columns[1]), max(columns[2]), sum(columns[3]), sum(columns[4]), \
        math.fsum(columns[5])


def measure(names=tuple(CASES), samples: int = SAMPLES) -> list[dict]:
    WORK.mkdir(parents=True, exist_ok=True)
    pool = _core.ThreadPool(1)
    rows = []
    for case in names:
        slab, directions = CASES[case]
        coarse, truth = (solved(slab, directions, nodes, pool) for nodes in NODES)
        solver_error = abs(truth - coarse) / truth
        for method, walk, table_error in walks(slab, directions, pool):
            path = WORK / f"{case}-{method.replace(', ', '-')}.json"
            total, squares, largest, count, events, seconds = run(path, walk, samples, pool)
            mean = total / count
            error = math.sqrt(max(squares / count - mean * mean, 0.0) / (count - 1)) / mean
            rows.append({
                "case": case, "method": method, "samples": count, "value": mean, "truth": truth,
                "difference": mean / truth - 1.0, "standard_error": error, "solver_error": solver_error,
                "table_error": table_error,
                "z": (mean / truth - 1.0) / math.hypot(error, solver_error, table_error),
                "largest_weight": largest / mean, "largest_share": largest**2 / squares,
                "events_per_sample": events / count, "cpu_seconds": seconds})
            print(f"hard: {case}, {method}: {mean:.8g}, solver {truth:.8g}, Z = {rows[-1]['z']:.2f}, "
                  f"{seconds:.0f} s", flush=True)
    return rows


def main(names) -> int:
    unknown = [name for name in names if name not in CASES]
    if unknown:
        print(f"hard: {unknown[0]}: must be one of {', '.join(CASES)}", file=sys.stderr)
        return 2
    rows = measure(names or tuple(CASES))
    if not names:
        tables.write("hard", rows)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
