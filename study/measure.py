# SPDX-License-Identifier: GPL-3.0-or-later
"""Variance and cost of one walk, and the rows of one cell: every method against the same exact value.

The number of samples is fixed before the run, from the time per sample of a pilot: a run that is stopped by the clock
leaves out its longest trees. Several batches give the accuracy of the variance itself."""

import functools
import math
import statistics
import time

import numpy as np
from grid import DIRECTIONS, Cell
from walks import BASELINE, METHODS, Slab, make

from lamina import _core

BATCHES = 10
SECONDS = 0.25  # CPU time per measurement
MOST_SECONDS = 8.0  # a walk is not measured if its least number of samples takes longer
SHARE = 0.1  # share of one sample in the sum of squares above which a variance is not reliable
SOLVER_ERROR = 2e-5  # relative, of the exact values
NODES = 64


def run(walk, exact: float, seed: int, seconds: float = SECONDS, exact_error: float = SOLVER_ERROR) -> dict:
    """Variance, cost and Z-score of a walk, as columns."""
    pool = _core.ThreadPool(1)
    started = time.process_time()
    _core.run_walk(walk, seed + 1, 0, 1, pool)
    block = time.process_time() - started
    if block * BATCHES > MOST_SECONDS:
        return {"status": f"not measured: would take {block * BATCHES:.0f} s"}
    blocks = max(1, round(seconds / (BATCHES * block)))
    tallies, times = [], []
    for batch in range(BATCHES):
        started = time.process_time()
        tallies.append(_core.run_walk(walk, seed, batch * blocks, (batch + 1) * blocks, pool))
        times.append(time.process_time() - started)
    return evaluate(tallies, times, exact, exact_error)


def evaluate(tallies: list, times: list[float], exact: float, exact_error: float) -> dict:
    """Columns from the tallies (sum, squares, largest, count, events) and CPU seconds of batches."""
    count = sum(tally[3] for tally in tallies)
    mean = math.fsum(tally[0] for tally in tallies) / count
    squares = math.fsum(tally[1] for tally in tallies)
    each = tallies[0][3]
    # Relative variances: about the common mean, in units of the exact value.
    spreads = [(tally[1] - 2.0 * mean * tally[0]) / each + mean * mean for tally in tallies]
    variance = statistics.fmean(spreads) / exact**2
    variance_error = statistics.stdev(spreads) / exact**2 / math.sqrt(len(spreads))
    per_sample = [seconds / each for seconds in times]
    cost = statistics.median(per_sample)
    cost_error = 1.25 * statistics.stdev(per_sample) / math.sqrt(len(per_sample))
    standard_error = math.sqrt(variance / count)
    largest = max(tally[2] for tally in tallies)
    share = largest**2 / squares if squares > 0.0 else 1.0
    return {
        "status": "ok" if share <= SHARE else "variance not reliable",
        "samples": count, "variance": variance, "variance_error": variance_error,
        "events": sum(tally[4] for tally in tallies) / count, "cpu_us": 1e6 * cost, "cpu_us_error": 1e6 * cost_error,
        "largest_weight": largest / exact, "largest_share": share,
        "z": (mean / exact - 1.0) / math.hypot(standard_error, exact_error),
    }


@functools.lru_cache(maxsize=4)
def solution(slab: Slab):
    return _core.solve_at(slab.stack(), NODES, 1e-7, _core.ThreadPool(1), slab.tau)


def exact_value(cell: Cell) -> float:
    arrays = (np.array([x]) for x in DIRECTIONS[cell.directions])
    return float(solution(cell.slab).points(_core.Side.top, _core.Path.reflect, *arrays, _core.ThreadPool(1))[0])


def measure(cell: Cell, seconds: float = SECONDS) -> list[dict]:
    """The rows of a cell, one for each method that applies, with their ratios to the baseline."""
    exact = exact_value(cell)
    rows = []
    for number, method in enumerate(METHODS):
        seed = 1000 * cell.number + 10 * number
        made = make(method, cell.slab, DIRECTIONS[cell.directions])
        if made is not None:
            rows.append({**cell.columns(), "method": method, "setup_ms": 1e3 * made.setup,
                         **run(made.walk, exact, seed, seconds)})
    compare(rows)
    return rows


def compare(rows: list[dict]) -> None:
    """Adds the ratio of each row's efficiency, 1 / (variance x time), to that of the baseline, its relative error, and
    the ratio of the times to .1 % standard error, set-up included."""
    base = next(row for row in rows if row["method"] == BASELINE)
    for row in rows:
        if "variance" not in row or "variance" not in base:
            continue
        row["ratio"] = work(base) / work(row)
        row["ratio_error"] = math.sqrt(doubt(row)**2 + (doubt(base)**2 if row is not base else 0.0))
        row["time_ratio"] = time_to(base, 1e-3) / time_to(row, 1e-3)


def work(row: dict) -> float:
    """Relative variance times seconds, the reciprocal of efficiency. Not below rounding."""
    return 1e-6 * max(row["variance"], 1e-16) * row["cpu_us"]


def doubt(row: dict) -> float:
    """Relative standard error of `work`."""
    return math.hypot(row["variance_error"] / max(row["variance"], 1e-16), row["cpu_us_error"] / row["cpu_us"])


def time_to(row: dict, error: float) -> float:
    """Seconds to this relative standard error."""
    return 1e-3 * row["setup_ms"] + work(row) / error**2
