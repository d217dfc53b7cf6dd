# SPDX-License-Identifier: GPL-3.0-or-later
"""Repeats the choice of the dictionary of reflection lobes, and compares the result with the shipped dictionary.

    python tools/choose_lobes.py [--count 35] [--every 1] [--limit 28]

The pool holds 258 closures of Cycles: a grid over their parameters, and the shipped ones. The error of a dictionary is
the mean over the stacks of tests/data/fit_stacks.json without rough boundaries. Each stack is fitted by BEST closures
of the dictionary, chosen as in a bake, at preview quality and for every sixth view. The choice is backward elimination,
a greedy selection: of the closures in use, the next one to be dropped is the one whose loss raises the error least.
Closures that no stack uses are dropped at once.

The shipped dictionary was found in the same way on random slabs instead of these stacks. Prints the error with the
complete pool, with the shipped dictionary, and with the remaining closures on the way down to `--count`.
"""

import argparse
import itertools
import json
import time
from pathlib import Path

import numpy as np

from lamina import Interface, Stack, _core
from lamina.baking.fit.slices import slices, solve_rows
from lamina.closures import lobes
from lamina.closures.closure_table import grid_for, light_grid, view_cosines
from lamina.closures.microfacet_lobes import fresnel_ggx, ggx
from lamina.solver.core_calls import thread_pool

STACKS = Path(__file__).resolve().parent.parent / "tests/data/fit_stacks.json"
BEST = 6  # closures of a mixture
STRIDE = 6  # of the view columns
ALBEDO_GRID = (96, 64)


def pool_of_lobes(every):
    """Every `every`-th lobe of a grid over the parameters of all families, and all shipped ones."""
    tilts = (-75.0, -60.0, -45.0, -30.0, -15.0, 15.0, 30.0, 45.0, 60.0, 75.0)
    made = [lobes.diffuse(("tilt", tilt)) for tilt in tilts]
    indices = (1.003, 1.01, 1.03, 1.06, 1.1, 1.2, 1.3, 1.5, 1.7, 2.0, 3.0)
    made += [fresnel_ggx(ior, roughness=roughness) for ior in indices for roughness in (0.5, 0.7, 0.85, 1.0)]
    made += [ggx(roughness, anisotropy=anisotropy)
             for roughness in (0.5, 0.6, 0.7, 0.8, 0.9, 1.0) for anisotropy in (0.0, 0.3, 0.5, 0.7)]
    made += [lobes.sheen_ashikhmin(sigma) for sigma in (0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)]
    shapes = [(0.01, 0.55), (0.01, 1.0), (0.05, 0.6), (0.15, 0.2), (0.15, 0.5), (0.3, 0.3), (0.3, 0.6), (0.5, 0.5),
              (0.6, 0.3), (0.75, 0.25), (0.9, 0.1), (1.0, 0.0)]
    normals = ["N", "I", "N+I", *(("tilt", tilt) for tilt in tilts)]
    made += [lobes.toon(*shape, normal) for shape, normal in itertools.product(shapes, normals)]
    made += [lobes.toon_glossy(*shape) for shape in shapes]
    shipped = [lobe for lobe in lobes.DICTIONARY if lobe.side == "reflection"]
    return list({lobe.id: lobe for lobe in (*shipped, *made[::every])}.values()), [lobe.id for lobe in shipped]


def closure_table(made, grid):
    """The core's table of these lobes at every STRIDE-th view."""
    mu_o = view_cosines()[::STRIDE]
    shape = (len(mu_o), len(grid.solid_angle))
    args = (mu_o[:, None, None], grid.mu[None, :, None], grid.dphi[None, None, :])
    values = np.stack([lobe.evaluate(*args).reshape(shape) for lobe in made], axis=1)
    dense = light_grid(*ALBEDO_GRID)
    args = (mu_o[:, None, None], dense.mu[None, :, None], dense.dphi[None, None, :])
    albedo = np.stack([lobe.evaluate(*args).reshape(len(mu_o), -1) @ dense.solid_angle for lobe in made], axis=1)
    return _core.ClosureTable(values, grid.solid_angle, np.ascontiguousarray(albedo))


def targets_of(table, stack, grid, pool):
    """Slices of the light that a stack reflects, as the core's targets."""
    solved = solve_rows(stack, "preview", 0, lambda *_: None)
    seen = slices(solved, grid, pool, lambda *_: None)["reflection"]
    albedo = np.ascontiguousarray(seen.albedo[:, :, :, ::STRIDE])
    values = np.ascontiguousarray(seen.values[:, :, :, ::STRIDE]).reshape(-1, albedo.shape[3], seen.values.shape[-1])
    return [one for one in table.targets(values, albedo.reshape(-1, albedo.shape[3]), pool) if one.norm2 > 0.0]


def stacks(limit):
    """The first stacks of the list on a base and without facets."""
    found = []
    for entry in json.loads(STACKS.read_text(encoding="utf-8")):
        stack = Stack.from_json({key: value for key, value in entry.items() if key not in ("id", "blind")})
        has_facets = any(isinstance(layer, Interface) for layer in stack.layers) or hasattr(stack.base, "alpha")
        if not has_facets and stack.base is not None:
            found.append(stack)
    return found[:limit]


class Judge:
    """Mixtures of the BEST closures of a dictionary, for stacks by number."""

    def __init__(self, table, targets, count, pool):
        self._table, self._targets, self._pool = table, targets, pool
        self._options = _core.SelectionOptions()
        self._options.swap_passes = 0
        self._options.penalty = [1.0] * count
        self.count = len(targets)

    def __call__(self, stack, dictionary):
        """(error, closures used) of the mixture for a stack."""
        self._options.closures = min(BEST, len(dictionary))
        found = self._table.select(self._targets[stack], self._options, sorted(dictionary), [], self._pool)
        return found.mean_error, set(found.closures)

    def error(self, dictionary):
        """The mean error over all stacks."""
        return float(np.mean([self(stack, dictionary)[0] for stack in range(self.count)]))


def eliminate(judge, dictionary, wanted):
    """(remaining closures, mean error) after each dropped closure, until `wanted` remain."""
    mixtures = [judge(stack, dictionary) for stack in range(judge.count)]
    left = set().union(*(used for _, used in mixtures))
    yield left, float(np.mean([error for error, _ in mixtures]))
    while len(left) > wanted:
        trials = {}
        for k in left:
            trials[k] = {stack: judge(stack, left - {k})
                         for stack, (_, used) in enumerate(mixtures) if k in used}
        losses = {k: sum(new[0] - mixtures[stack][0] for stack, new in found.items()) for k, found in trials.items()}
        least = min(sorted(losses), key=losses.get)
        for stack, new in trials[least].items():
            mixtures[stack] = new
        left = left - {least}
        yield left, float(np.mean([error for error, _ in mixtures]))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=35, help="closures to choose (35, as shipped)")
    parser.add_argument("--every", type=int, default=1, help="take every N-th closure of the grid (1)")
    parser.add_argument("--limit", type=int, default=28, help="number of stacks to fit (28)")
    arguments = parser.parse_args()
    started, pool, grid = time.perf_counter(), thread_pool(0), grid_for("preview", None)
    made, shipped = pool_of_lobes(arguments.every)
    table = closure_table(made, grid)
    chosen_stacks = stacks(arguments.limit)
    judge = Judge(table, [targets_of(table, stack, grid, pool) for stack in chosen_stacks], len(made), pool)
    names = [lobe.id for lobe in made]
    print(f"{len(chosen_stacks)} stacks, {len(made)} closures; mean error of mixtures of {BEST}:")
    print(f"  {len(made):3d}, the whole pool          {judge.error(range(len(made))):.2%}")
    print(f"  {len(shipped):3d}, the shipped dictionary  {judge.error([names.index(name) for name in shipped]):.2%}")
    for left, error in eliminate(judge, set(range(len(made))), arguments.count):
        if len(left) % 10 == 0 or len(left) <= arguments.count:
            print(f"  {len(left):3d} left                     {error:.2%}", flush=True)
    kept = sorted(names[k] for k in left)
    print(f"{sum(name in shipped for name in kept)} of these are shipped: {', '.join(kept)}")
    print(f"{time.perf_counter() - started:.0f} s")


if __name__ == "__main__":
    main()
