# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake time by quality, wall clock, all threads."""

import statistics
import time

import lamina

HG = lamina.HenyeyGreenstein
STACKS = {
    "slab": lamina.Stack([lamina.Medium(albedo=0.9, tau=2.0, phase=HG(0.75))], base=lamina.Black()),
    "one layer, RGB, over Lambert": lamina.Stack(
        [lamina.Medium(albedo=[0.9, 0.8, 0.6], tau=1.0, phase=HG(0.6))], base=lamina.Lambert([0.5, 0.3, 0.1])),
    "three layers, RGB, over Lambert": lamina.Stack(
        [
            lamina.Medium(albedo=[0.95, 0.9, 0.8], tau=0.3, phase=HG(0.6)),
            lamina.Medium(albedo=[0.7, 0.8, 0.9], tau=1.0, phase=HG(0.3)),
            lamina.Medium(albedo=[0.9, 0.6, 0.4], tau=2.0),
        ],
        base=lamina.Lambert([0.5, 0.3, 0.1])),
    "one varying layer, RGB, over Lambert": lamina.Stack(
        [lamina.Medium(albedo=[0.9, 0.8, 0.6], tau=4.0, phase=HG(0.6), varying=True)],
        base=lamina.Lambert([0.5, 0.3, 0.1])),
}


def measure(repeats=7, stacks=None):
    """A list of {stack, quality, ms, fit_error}, for the first `stacks`. The first bake of the process, which computes
    the table of closures, has a row of its own."""
    start = time.perf_counter()
    lamina.bake(STACKS["slab"], "preview")
    rows = [{"stack": "first bake of a process", "quality": "preview", "ms": 1e3 * (time.perf_counter() - start)}]
    for name, stack in list(STACKS.items())[:stacks]:
        for quality in ("preview", "final"):
            times = []
            for _ in range(repeats):
                start = time.perf_counter()
                lut = lamina.bake(stack, quality)
                times.append(time.perf_counter() - start)
            rows.append({"stack": name, "quality": quality, "ms": 1e3 * statistics.median(times),
                         "fit_error": lut.report["fit_error"], "closures": lut.report["closures"]})
    return rows
