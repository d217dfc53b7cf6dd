# SPDX-License-Identifier: GPL-3.0-or-later
"""Walks on the standard slab: seconds to .1 % error of its BRDF, against seconds of Mitsuba's volpath to .1 % of its
directional albedo, with the LLVM and the scalar variant; events and samples per second, and the speed-up by a second
thread."""

import math
import statistics

import mitsuba_peer

import lamina

DIRECTIONS = (0.5, 0.5, math.pi / 2)
ERROR = 1e-3
THREADS = 2
SAMPLES = 1 << 20
RR_DEPTHS = (5, 100)


def measure(repeats: int = 5, error: float = ERROR, samples: int = SAMPLES) -> list[dict]:
    """Rows of all walks; `samples` of a run that measures rates."""
    albedo, tau, g = mitsuba_peer.SLAB
    stack = lamina.Stack([lamina.Medium(albedo=albedo, tau=tau, phase=lamina.HenyeyGreenstein(g))])
    peers = mitsuba(repeats, error, samples)
    fastest = min(peer["seconds"] for peer in peers)
    rows = []
    for method in ("scattering", "transfer"):
        found = [lamina.estimate(stack, *DIRECTIONS, method=method, target_error=error, seed=seed, threads=THREADS)
                 for seed in range(repeats)]
        seconds = statistics.median(one.seconds for one in found)
        rows.append({"name": f"Lamina, {method}: BRDF at (.5, .5, 90°)", "seconds": seconds,
                     "times_sooner": fastest / seconds, **_rates(stack, method, repeats, samples),
                     "value": float(found[0].value[0])})
    return [*rows, *({**peer, "times_sooner": fastest / peer["seconds"]} for peer in peers)]


def mitsuba(repeats: int, error: float, paths: int) -> list[dict]:
    """Seconds to `error` from variance and paths per second. The compilation of kernels is reported separately."""
    return [{"name": f"Mitsuba {run['variant']}, volpath: directional albedo at .5",
             "seconds": run["variance"] / error**2 / run["paths_per_second"],
             "samples_per_second": run["paths_per_second"],
             **{key: run[key] for key in ("variance", "value", "compilation") if key in run}}
            for run in mitsuba_peer.measure(paths, RR_DEPTHS, repeats)]


def _rates(stack, method: str, repeats: int, samples: int) -> dict:
    """Relative variance, samples and events per second with two threads, and the speed-up by the second one."""
    rates: dict = {1: [], THREADS: []}
    for turn in range(repeats):
        for count, found in rates.items():
            one = lamina.estimate(stack, *DIRECTIONS, method=method, samples=samples, seed=turn, threads=count)
            found.append(float(one.samples[0]) / one.seconds)
    # Take the fastest round of each, because other load on the machine only slows a round down.
    single, double = (max(rates[count]) for count in (1, THREADS))
    return {"samples_per_second": double, "events_per_second": double * float(one.events[0] / one.samples[0]),
            "second_thread": double / single,
            "variance": float(one.samples[0] * (one.stderr[0] / one.value[0]) ** 2)}
