# SPDX-License-Identifier: GPL-3.0-or-later
"""Solver speed: the matched slab (albedo .9, tau 2, HG .75), R and T for all incidences and azimuths,
against CDISORT and PythonicDISORT at stated accuracy, CPU time, in turns in one run."""

import statistics
import time

import numpy as np
from disort_peers import cdisort, pythonic_disort

import lamina

SLAB = (0.9, 2.0, 0.75)
NODES = 32
# Directions for the errors: between the nodes of all codes, mu >= .05, forward and backward included.
MU_O = np.array([0.05, 0.12, 0.3, 0.55, 0.8, 0.97])
MU_I = np.array([0.06, 0.2, 0.45, 0.7, 0.99])
DPHI = np.linspace(0.0, np.pi, 9)
# CDISORT (nanodisort 0.3) overruns its memory if it is asked for more cosines than it has streams. The peers are
# therefore asked for half of the view cosines.
ALL_DPHI = np.linspace(0.0, np.pi, 16)


def measure(repeats=5, streams=(32, 64)):
    """A list of {name, cpu_ms, error, ...}. `streams` of the other codes."""
    truth = cdisort(*SLAB, 128, MU_O, MU_I, DPHI)
    mu = (np.arange(NODES) + 0.5) / NODES
    stack = lamina.Stack([lamina.Medium(albedo=SLAB[0], tau=SLAB[1], phase=lamina.HenyeyGreenstein(SLAB[2]))])

    def lamina_solve():
        return lamina.solve(stack, threads=1)

    def lamina_values(mu_o, mu_i, dphi):
        solved = lamina_solve()
        return [solved.grid(path, mu_o, mu_i, dphi)[..., 0] for path in ("reflect", "transmit")]

    rows = {"Lamina, solve (all incidences, all azimuth orders)": lamina_solve,
            "Lamina, solve and 32 x 32 x 16 values of R and T": lambda: lamina_values(mu, mu, ALL_DPHI)}
    errors = {name: _error(lamina_values(MU_O, MU_I, DPHI), truth) for name in rows}
    for label, code in (("CDISORT", cdisort), ("PythonicDISORT", pythonic_disort)):
        for count in streams:
            name = f"{label}, {count} streams, 16 x 32 x 16 values of R and T"
            rows[name] = lambda code=code, count=count: code(*SLAB, count, mu[::2], mu, ALL_DPHI)
            errors[name] = _error(code(*SLAB, count, MU_O, MU_I, DPHI), truth)
    times = {name: [] for name in rows}
    for turn in range(repeats):
        for name, work in rows.items():
            if turn > 0 and name.startswith("PythonicDISORT"):
                continue  # half a minute each; one turn shows the order of magnitude
            start = time.process_time()
            work()
            times[name].append(time.process_time() - start)
    solved = lamina_solve()
    fastest = statistics.median(times[next(iter(rows))])
    return [
        {"name": name, "cpu_ms": 1e3 * statistics.median(times[name]), "error": errors[name],
         "times_lamina": statistics.median(times[name]) / fastest}
        for name in rows
    ] + [{"name": "Lamina chose", "nodes": solved.nodes, "orders": solved.orders}]


def _error(values, truth):
    """Largest relative error of R and T over the directions."""
    return float(max(np.max(np.abs(v / t - 1.0)) for v, t in zip(values, truth, strict=True)))
