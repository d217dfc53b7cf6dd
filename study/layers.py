# SPDX-License-Identifier: GPL-3.0-or-later
"""The adding walk against the transfer walk on stacks of two and three layers, with and without interfaces."""

import time

from grid import DIRECTIONS
from measure import SECONDS, compare, run
from walks import BASELINE

import lamina
from lamina import _core
from lamina.solver.core_stack import core_stack


def _medium(albedo, tau, g):
    return lamina.Medium(albedo=albedo, tau=tau, phase=lamina.HenyeyGreenstein(g))


STACKS = {
    "thin over thick": lamina.Stack([_medium(0.9, 0.5, 0.6), _medium(0.99, 10.0, 0.8)]),
    "two thick": lamina.Stack([_medium(0.99, 10.0, 0.8), _medium(0.9, 10.0, 0.0)]),
    "three": lamina.Stack([_medium(0.9, 0.5, 0.6), _medium(0.7, 1.0, -0.3),
                           lamina.Medium(albedo=0.99, tau=2.0, phase=lamina.Rayleigh())]),
    "three thick, albedo 1": lamina.Stack([_medium(1.0, 5.0, 0.8), _medium(1.0, 5.0, 0.0), _medium(1.0, 5.0, 0.8)]),
    "varnish on paint": lamina.Stack([lamina.Interface(1.5), _medium(0.8, 1.0, 0.6)], lamina.Lambert(0.5)),
    "rough varnish on paint": lamina.Stack([lamina.Interface(1.5, 0.3), _medium(0.8, 1.0, 0.5)],
                                           lamina.Lambert(0.5)),
    "coat over two media": lamina.Stack([lamina.Interface(1.5), _medium(0.9, 1.0, 0.8), _medium(0.99, 5.0, 0.5)],
                                        lamina.Lambert(0.8)),
    "two indices": lamina.Stack([lamina.Interface(1.33), _medium(0.9, 0.5, 0.6), lamina.Interface(1.6),
                                 _medium(0.8, 1.5, 0.0), lamina.Interface(1.0)]),
    "dust on rough metal": lamina.Stack([_medium(0.9, 0.3, 0.4)], lamina.Conductor(0.4, 2.5, alpha=0.3)),
}
# Relative pointwise tolerance of the solver here. The solver's own guarantee is for cosines >= .05.
TOLERANCE = 2e-4


def walks(stack, directions, pool):
    """(method, walk, set-up in seconds, error of its tables)."""
    target = _core.WalkTarget(*directions)
    for method, way in ((BASELINE, _core.NextEvent.at_collision), ("transfer", _core.NextEvent.fitting)):
        started = time.process_time()
        walk = _core.transfer_walk(stack, target, way)
        yield method, walk, time.process_time() - started, 0.0
    started = time.process_time()
    walk, error = _core.adding_walk(stack, target, pool)
    yield "adding", walk, time.process_time() - started, error


def measure(name: str, seconds: float = SECONDS) -> list[dict]:
    """The rows of a stack: every pair of directions by every method."""
    pool = _core.ThreadPool(1)
    _, layers, base = core_stack(STACKS[name], 0)
    core = _core.Stack(layers, base)
    solved = _core.solve(core, TOLERANCE, pool)
    rows = []
    for number, (directions, at) in enumerate(DIRECTIONS.items()):
        exact = float(solved.points(_core.Side.top, _core.Path.reflect, *([x] for x in at), pool)[0])
        found = []
        for method, walk, setup, error in walks(core, at, pool):
            seed = 500_000 + 1000 * list(STACKS).index(name) + 10 * number + len(found)
            found.append({"stack": name, "directions": directions, "method": method, "setup_ms": 1e3 * setup,
                          "table_error": error, **run(walk, exact, seed, seconds, max(TOLERANCE, error))})
        compare(found)
        rows += found
    return rows
