# SPDX-License-Identifier: GPL-3.0-or-later
"""Walks on the standard slab: seconds to .1 % of its BRDF against Mitsuba's volpath to .1 % of its directional
albedo, events and samples per second, and what a second thread brings."""

import math
import statistics
import time

import mitsuba_peer

import lamina
from lamina import _core
from lamina.solve import core_stack

DIRECTIONS = (0.5, 0.5, math.pi / 2)
ERROR = 1e-3
THREADS = 2
PATHS = 1 << 20
BLOCKS = 256


def measure(repeats: int = 5) -> list[dict]:
    albedo, tau, g = mitsuba_peer.SLAB
    stack = lamina.Stack([lamina.Medium(albedo=albedo, tau=tau, phase=lamina.HenyeyGreenstein(g))])
    peer = mitsuba(repeats)
    rows = []
    for method in ("scattering", "transfer"):
        found = [lamina.estimate(stack, *DIRECTIONS, method=method, target_error=ERROR, seed=seed, threads=THREADS)
                 for seed in range(repeats)]
        seconds = statistics.median(one.seconds for one in found)
        rows.append({"name": f"Lamina, {method}: BRDF at (.5, .5, 90°)", "seconds": seconds,
                     "times_sooner": peer["seconds"] / seconds, **_rates(stack, method, repeats),
                     "value": float(found[0].value[0])})
    return [*rows, peer]


def mitsuba(repeats: int) -> dict:
    """Seconds to ERROR from variance and paths per second, with whichever depth of its roulette is better."""
    runs = [mitsuba_peer.measure(PATHS, depth, repeats) for depth in (5, 100)]
    best = min(runs, key=lambda run: run["variance"] / run["paths_per_second"])
    return {"name": f"Mitsuba {best['variant']}, volpath: directional albedo at .5",
            "seconds": best["variance"] / ERROR**2 / best["paths_per_second"], "times_sooner": 1.0,
            "samples_per_second": best["paths_per_second"], "variance": best["variance"], "value": best["value"]}


def _rates(stack, method: str, repeats: int) -> dict:
    """Relative variance, samples and events per second with two threads, and how much the second one brings."""
    _, layers, base = core_stack(stack, 0)
    ends = (*DIRECTIONS, _core.Side.top, _core.Path.reflect, False)
    walk = getattr(_core, f"{method}_walk")(_core.Stack(layers, base), *ends)
    rates: dict = {1: [], THREADS: []}
    pools = {count: _core.ThreadPool(count) for count in rates}
    for turn in range(repeats + 1):
        for count, pool in pools.items():
            started = time.perf_counter()
            total, squares, _, samples, events = _core.run_walk(walk, turn, 0, BLOCKS, pool)
            if turn > 0:
                rates[count].append(samples / (time.perf_counter() - started))
    # The fastest turn of each: other work beside it only ever slows one down.
    one, two = (max(rates[count]) for count in (1, THREADS))
    mean = total / samples
    return {"samples_per_second": two, "events_per_second": two * events / samples,
            "second_thread": two / one, "variance": squares / samples / mean**2 - 1.0}
