# SPDX-License-Identifier: GPL-3.0-or-later
"""Random walks and bakes on a Dask cluster or another executor, in parts. Merged estimates have the bytes of one
process; a bake is one part."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from typing import cast

import numpy as np

from ..baking.bake import bake
from ..baking.table.lut import Lut
from ..common.arguments import check_seed
from ..common.errors import ArgumentError, quoted
from ..common.parts import each_part
from ..common.progress import Progress, stepper
from ..interior.estimates import ExitEstimate, LightEstimate
from ..interior.lamps import AnyLamp, Surroundings
from ..interior.occluders import Occluders
from ..interior.parts import elsewhere, merge_walks
from ..interior.problem import Lights, Problem, Samples, Surface, WalkPoints
from ..material.any_stack import AnyStack, as_stack
from ..walks.estimate import SAMPLES, Estimate, Query, blocks_of, chunks_in
from ..walks.estimate_searchlight import SearchlightEstimate, SearchlightQuery
from ..walks.searchlight_shards import run_searchlight_shard
from ..walks.shards import merge, run_shard
from .workers import shards, spread


def estimate(client, stack: AnyStack, mu_o: float | None, mu_i: float, dphi: float = 0.0, method: str = "transfer",
             samples: int | None = None, seed: int = 0, *, progress: Progress | None = None,
             cancel: Callable[[], bool] | None = None, side: str = "top", path: str = "reflect",
             parts: int | None = None) -> Estimate:
    """lamina.estimate on the cluster of `client`, or on an executor of concurrent.futures, with the same bytes;
    `seconds` is NaN. `parts`: the number of parts, by default four for each thread; the result does not depend on it.
    Raises ExtraMissing without Dask, and what lamina.estimate raises."""
    samples = SAMPLES if samples is None else samples
    call = functools.partial(run_shard, as_stack(stack), Query(mu_o, mu_i, dphi, side, path), method, samples, seed)
    return cast(Estimate, _walked(client, call, samples, seed, parts, stepper("the estimate", progress, cancel)))


def estimate_searchlight(client, stack: AnyStack, mu_i: float = 1.0, samples: int | None = None, seed: int = 0,
                         walk: str = "transfer", r=(), q=(), *, progress: Progress | None = None,
                         cancel: Callable[[], bool] | None = None, parts: int | None = None) -> SearchlightEstimate:
    """lamina.estimate_searchlight on the cluster of `client`, like `estimate`."""
    samples = SAMPLES if samples is None else samples
    call = functools.partial(run_searchlight_shard, as_stack(stack), SearchlightQuery(mu_i, walk, r, q), samples, seed)
    return cast(SearchlightEstimate,
                _walked(client, call, samples, seed, parts, stepper("the estimate", progress, cancel)))


def walk_in_mesh(client, solid, interior, points=None, normals=None, directions=None, surface: Surface | None = None,
                 samples: int = 256, *, seed: int = 0, progress: Progress | None = None,
                 cancel: Callable[[], bool] | None = None, parts: int | None = None) -> ExitEstimate:
    """lamina.walk_in_mesh on the cluster of `client`, like `estimate`."""
    problem = Problem(solid, interior, surface, None, WalkPoints.of(points, normals, directions))
    return cast(ExitEstimate, _walked_in_mesh(client, problem, Samples(samples, seed), parts,
                                              stepper("the walks", progress, cancel)))


def light_in_mesh(client, solid, interior, lamps: Sequence[AnyLamp] = (), points=None, normals=None, directions=None,
                  surface: Surface | None = None, *, samples: int = 256, seed: int = 0,
                  progress: Progress | None = None, cancel: Callable[[], bool] | None = None,
                  surroundings: Surroundings | None = None, parts: int | None = None,
                  occluders: Occluders | None = None) -> LightEstimate:
    """lamina.light_in_mesh on the cluster of `client`, like `estimate`."""
    lights = Lights(lamps, surroundings, occluders)
    problem = Problem(solid, interior, surface, lights, WalkPoints.of(points, normals, directions))
    return cast(LightEstimate, _walked_in_mesh(client, problem, Samples(samples, seed), parts,
                                               stepper("the walks", progress, cancel)))


def bakes(client, stacks: Sequence[AnyStack], quality: str = "final", basis: str = "standard",
          progress: Progress | None = None, cancel: Callable[[], bool] | None = None) -> list[Lut]:
    """lamina.bake of each of the stacks, on the cluster of `client`: the same tables in the same order. Raises
    ExtraMissing without Dask, ArgumentError, and what lamina.bake raises."""
    if isinstance(stacks, str) or not isinstance(stacks, Sequence):
        raise ArgumentError(f"stacks = {quoted(stacks)}: must be a list of stacks")
    given = list(enumerate(map(as_stack, stacks)))
    return each_part(functools.partial(_bake, quality, basis), given, stepper("the bakes", progress, cancel),
                     spread(client))


def _walked(client, call: Callable, samples: int, seed: int, parts: int | None, step: Progress):
    executor = spread(client)
    check_seed(seed)
    numbers = shards(executor, parts, chunks_in(blocks_of(samples)))
    return merge(each_part(functools.partial(_one_thread, call), numbers, step, executor))


def _walked_in_mesh(client, problem: Problem, samples: Samples, parts: int | None, step: Progress):
    executor, points = spread(client), problem.points.positions
    numbers = shards(executor, parts, len(np.atleast_2d(problem.solid.vertices if points is None else points)))
    return merge_walks(each_part(elsewhere(problem), [(samples, one) for one in numbers], step, executor))


def _one_thread(call: Callable, shard: tuple[int, int]):
    return call(shard, threads=1)


def _bake(quality: str, basis: str, numbered):
    return bake(numbered[1], quality, threads=1, basis=basis)
