# SPDX-License-Identifier: GPL-3.0-or-later
"""Walks with positions: both walks of a pencil beam against the deterministic searchlight."""

import math
import statistics
import time

from measure import BATCHES, MOST_SECONDS

import lamina
from lamina import _core
from lamina.material.millimetres import depth_knots
from lamina.solver.core_stack import core_stack
from lamina.walks.estimate_searchlight import WALKS
from lamina.walks.searchlight_moments import DISTANCE, FIRST_FREQUENCY, WEIGHT, SideMoments

SECONDS = 1.0  # CPU time per walk and stack
RADIUS, FREQUENCY = 1.0, 1.0  # mm, 1/mm
DOUBT = 0.2  # largest relative standard error of a variance; above, larger samples are still to be expected
TRUTH_ERROR = 1e-5  # share of the beam; for a mean distance, relative


def _medium(albedo, thickness, g=0.0):
    phase = lamina.HenyeyGreenstein(g) if g else lamina.Isotropic()
    return lamina.Medium(sigma_s=albedo, sigma_a=1.0 - albedo, thickness=thickness, phase=phase)


def _half_space(albedo, g=0.0):
    return lamina.Stack([_medium(albedo, math.inf, g)])


# All mean free paths are 1 mm.
STACKS = {
    "half-space, albedo .5": _half_space(0.5),
    "half-space, albedo .9": _half_space(0.9),
    "half-space, albedo .99": _half_space(0.99),
    "half-space, albedo .9, g .75": _half_space(0.9, 0.75),
    "slab 1 mm, albedo .9": lamina.Stack([_medium(0.9, 1.0)]),
    "slab 5 mm, albedo 1": lamina.Stack([_medium(1.0, 5.0)]),
    "slab 2 mm, albedo .9, g .75": lamina.Stack([_medium(0.9, 2.0, 0.75)]),
    "1 mm, albedo .9, on paper": lamina.Stack([_medium(0.9, 1.0)], lamina.Lambert(0.8)),
    "varnish, 1 mm, on paper": lamina.Stack([lamina.Interface(1.5), _medium(0.9, 1.0, 0.5)], lamina.Lambert(0.8)),
}


def knows(name: str, method: str) -> bool:
    """True if a walk applies to a stack: the walk of the scattering equation does not support boundaries."""
    return method == "transfer" or not any(isinstance(layer, lamina.Interface) for layer in STACKS[name].layers)


def measure(name: str, seconds: float = SECONDS) -> list[dict]:
    """The rows of a stack: each walk's relative variance and Z-score in each quantity, and its cost."""
    beam = lamina.searchlight(STACKS[name], threads=1)
    exact = {"flux": beam.reflectance[0], "flux within 1 mm": float(beam.reflected_inside(RADIUS)),
             "at 1/mm": float(beam.reflected_at(FREQUENCY)), "mean distance": beam.mean_distance[0]}
    rows = []
    for number, method in enumerate(WALKS):
        if knows(name, method):
            seed = 900_000 + 100 * list(STACKS).index(name) + 10 * number
            rows += [{"stack": name, "method": method, **row} for row in _walked(name, method, exact, seed, seconds)]
    _compare(rows)
    return rows


def _walked(name: str, method: str, exact: dict, seed: int, seconds: float) -> list[dict]:
    _, layers, base = core_stack(STACKS[name], 0)
    walk = getattr(_core, WALKS[method])(_core.Stack(layers, base), depth_knots(STACKS[name], 0), 1.0)
    pool = _core.ThreadPool(1)

    def run(first, last, of_seed=seed):
        started = time.process_time()
        tally = _core.run_lateral_walk(walk, [RADIUS], [FREQUENCY], of_seed, first, last, pool)
        return tally, time.process_time() - started

    block = max(run(0, 1, seed + 1)[1], 1e-6)
    blocks = max(1, round(min(seconds, MOST_SECONDS) / (BATCHES * block)))
    batches = [run(k * blocks, (k + 1) * blocks) for k in range(BATCHES)]
    tallies = [tally for tally, _ in batches]
    samples = sum(tally[2] for tally in tallies)
    each = tallies[0][2]
    cost = statistics.median(spent / each for _, spent in batches)
    whole = _values(SideMoments.of([tally[0] for tally in tallies], samples))
    parts = [_values(SideMoments.of([tally[0]], each)) for tally in tallies]
    rows = []
    for quantity, truth in exact.items():
        value, error = whole[quantity]
        variances = [each * (part[quantity][1] / truth) ** 2 for part in parts]
        variance = samples * (error / truth) ** 2
        doubt = statistics.stdev(variances) / math.sqrt(BATCHES)
        off = TRUTH_ERROR * max(1.0, truth)
        rows.append({
            "quantity": quantity, "status": "ok" if doubt <= DOUBT * variance else "variance not reliable",
            "truth": truth, "value": value, "samples": samples, "variance": variance, "variance_error": doubt,
            "events": sum(tally[3] for tally in tallies) / samples, "cpu_us": 1e6 * cost,
            "z": (value - truth) / math.hypot(error, off)})
    return rows


def _values(side: SideMoments) -> dict:
    """(value, standard error) of every quantity."""
    return {"flux": (side.mean[WEIGHT], side.error[WEIGHT]),
            "flux within 1 mm": (side.inside[0], side.inside_error[0]),
            "at 1/mm": (side.mean[FIRST_FREQUENCY], side.error[FIRST_FREQUENCY]),
            "mean distance": side.mean_power(DISTANCE)}


def _compare(rows: list[dict]) -> None:
    """Adds the ratio of each row's efficiency, 1 / (variance x time), to that of the transfer walk."""
    for row in rows:
        base = next(r for r in rows if r["method"] == "transfer" and r["quantity"] == row["quantity"])
        row["ratio"] = base["variance"] * base["cpu_us"] / (row["variance"] * row["cpu_us"])
        row["ratio_error"] = math.hypot(row["variance_error"] / row["variance"],
                                        base["variance_error"] / base["variance"] if row is not base else 0.0)
