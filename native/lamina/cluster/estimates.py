# SPDX-License-Identifier: GPL-3.0-or-later
"""Random walks on a Dask cluster, in shards. The merged estimate has the bytes of one process."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import cast

import numpy as np

from ..common.arguments import check_seed
from ..common.progress import Progress
from ..interior.estimates import ExitEstimate, LightEstimate
from ..interior.lamps import AnyLamp, Surroundings
from ..interior.parts import merge_walks, walk_part
from ..interior.walk import Surface
from ..material.any_stack import AnyStack, as_stack
from ..walks.estimate import Estimate, Query, blocks_of, chunks_in
from ..walks.estimate_searchlight import SearchlightEstimate, SearchlightQuery
from ..walks.searchlight_shards import run_searchlight_shard
from ..walks.shards import merge, run_shard
from .gather import gather, shards


def estimate(client, stack: AnyStack, mu_o: float | None, mu_i: float, dphi: float = 0.0, method: str = "transfer",
             samples: int | None = None, seed: int = 0, progress: Progress | None = None,
             cancel: Callable[[], bool] | None = None, side: str = "top", path: str = "reflect",
             parts: int | None = None) -> Estimate:
    """lamina.estimate on the cluster of `client`, with the same bytes; `seconds` is NaN. `parts`: the number of parts,
    by default four for each thread of the cluster; the result does not depend on it. Raises ExtraMissing without
    Dask, and what lamina.estimate raises."""
    stack, query = as_stack(stack), Query(mu_o, mu_i, dphi, side, path)
    check_seed(seed)
    numbers = shards(client, parts, chunks_in(blocks_of(samples)))
    found = gather(client, _estimate_part, [(one,) for one in numbers], (stack, query, method, samples, seed),
                   "the estimate", progress, cancel)
    return cast(Estimate, merge(found))


def estimate_searchlight(client, stack: AnyStack, mu_i: float = 1.0, samples: int | None = None, seed: int = 0,
                         walk: str = "transfer", r=(), q=(), progress: Progress | None = None,
                         cancel: Callable[[], bool] | None = None, parts: int | None = None) -> SearchlightEstimate:
    """lamina.estimate_searchlight on the cluster of `client`, like `estimate`."""
    stack, query = as_stack(stack), SearchlightQuery(mu_i, walk, r, q)
    check_seed(seed)
    numbers = shards(client, parts, chunks_in(blocks_of(samples)))
    found = gather(client, _searchlight_part, [(one,) for one in numbers], (stack, query, samples, seed),
                   "the estimate", progress, cancel)
    return cast(SearchlightEstimate, merge(found))


def walk_in_mesh(client, solid, interior, points=None, normals=None, directions=None, surface: Surface | None = None,
                 samples: int = 256, seed: int = 0, progress: Progress | None = None,
                 cancel: Callable[[], bool] | None = None, parts: int | None = None) -> ExitEstimate:
    """lamina.walk_in_mesh on the cluster of `client`, like `estimate`."""
    return cast(ExitEstimate, _walks(client, None, solid, interior, points, normals, directions, surface, samples, seed,
                                     None, progress, cancel, parts))


def light_in_mesh(client, solid, interior, lamps: Sequence[AnyLamp] = (), points=None, normals=None, directions=None,
                  surface: Surface | None = None, samples: int = 256, seed: int = 0, progress: Progress | None = None,
                  cancel: Callable[[], bool] | None = None, surroundings: Surroundings | None = None,
                  parts: int | None = None) -> LightEstimate:
    """lamina.light_in_mesh on the cluster of `client`, like `estimate`."""
    return cast(LightEstimate, _walks(client, list(lamps), solid, interior, points, normals, directions, surface,
                                      samples, seed, surroundings, progress, cancel, parts))


def _walks(client, lamps, solid, interior, points, normals, directions, surface, samples, seed, surroundings,
           progress, cancel, parts):
    count = len(solid.vertices) if points is None else len(np.atleast_2d(points))
    shared = (solid, interior, lamps, points, normals, directions, surface, samples, seed, surroundings)
    found = gather(client, _mesh_part, [(one,) for one in shards(client, parts, count)], shared, "the walks", progress,
                   cancel)
    return merge_walks(found)


def _estimate_part(stack, query, method, samples, seed, shard):
    return run_shard(stack, query, method, samples, seed, shard, threads=1)


def _searchlight_part(stack, query, samples, seed, shard):
    return run_searchlight_shard(stack, query, samples, seed, shard, threads=1)


def _mesh_part(solid, interior, lamps, points, normals, directions, surface, samples, seed, surroundings, shard):
    return walk_part(solid, interior, shard, lamps, points, normals, directions, surface, samples, seed, 1,
                     surroundings=surroundings)
