# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust on a Dask cluster: the rays of each mesh in parts. The dust has the bytes of one process."""

from __future__ import annotations

import functools
import itertools
import uuid
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Executor
from typing import Any

from ..common.arguments import check_seed
from ..common.errors import ArgumentError, quoted
from ..common.kept import kept
from ..common.parts import each_part, share_of
from ..common.progress import Progress, silent, stepper
from ..kinds.dust import Settling
from ..settling.mesh import Mesh, checked_meshes
from ..settling.parts import PartedDust
from ..settling.rays import Rays
from ..settling.settle import Dust, settings_of
from .workers import shards, spread


def settle_each(client, surfaces: Sequence[Mesh], occluders: Iterable[Mesh] = (), settings: Settling | None = None,
                seed: int = 0, progress: Progress | None = None, cancel: Callable[[], bool] | None = None,
                parts: int | None = None) -> list[Dust]:
    """lamina.dust.settle on each of the surfaces, with all other surfaces and the `occluders` in the way, on the
    cluster of `client`, with the same bytes; `statistics.seconds` is the sum over the parts. `parts`: the number of
    parts of each surface, [1, 4096]; by default the surfaces share four for each thread of the cluster, by their
    numbers of points. The result does not depend on it. Meshes are read in this process, which needs Embree too. Raises
    ExtraMissing without Dask, ArgumentError, and what lamina.dust.settle raises."""
    executor = spread(client)
    if not isinstance(surfaces, Sequence):
        raise ArgumentError(f"surfaces = {quoted(surfaces)}: must be a list of meshes")
    settings = settings_of(settings)
    check_seed(seed)
    step = stepper("the dust", progress, cancel)
    meshes = checked_meshes(surfaces, "surfaces")
    further = checked_meshes(occluders, "occluders")
    works = []
    for number, mesh in enumerate(meshes):
        step(0.0, f"reading mesh {number + 1} of {len(meshes)}")
        others = [*meshes[:number], *meshes[number + 1:], *further]
        works.append(PartedDust(mesh, others, settings, seed, silent))
    ranges = _ranges(executor, [len(work.starts) for work in works], parts)
    call = functools.partial(_part, uuid.uuid4().hex, [(work.place, work.starts, work.window) for work in works])
    found = iter(each_part(call, [(number, one) for number, own in enumerate(ranges) for one in (*own, None)], step,
                           executor))
    return [work.dust(list(itertools.islice(found, len(own))), next(found))
            for work, own in zip(works, ranges, strict=True)]


def _ranges(executor: Executor, counts: list[int], parts: int | None) -> list[list[range]]:
    """For each surface of that many points, the points of each part."""
    ranges = []
    for count in counts:
        wanted = parts
        if parts is None:
            wanted = max(1, round(len(shards(executor, None, sum(counts))) * count / sum(counts)))
        ranges.append([share_of(shard, count) for shard in shards(executor, wanted, count)])
    return ranges


def _part(run: str, works: list, part: tuple[int, range | None]) -> Any:
    """The rays of points of a surface, by its number; None: its grains that are traced from above."""
    number, points = part
    place, starts, window = works[number]
    rays = kept((run, number), lambda: Rays(place, 1, silent))
    if points is None:
        return rays.grains(window)
    return rays.traced(starts.part(points.start, points.stop), points.start, silent)
