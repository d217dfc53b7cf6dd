# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust on a Dask cluster: the rays of each mesh in parts. The dust has the bytes of one process."""

from __future__ import annotations

import uuid
from collections.abc import Callable, Iterable, Sequence
from typing import Any

from ..common.arguments import check_seed
from ..common.errors import ArgumentError, quoted
from ..common.progress import Progress, silent, stepper
from ..kinds.dust import Settling
from ..settling.mesh import Mesh, checked_mesh
from ..settling.parts import PartedDust
from ..settling.rays import Rays
from ..settling.settle import Dust
from .gather import checked, gather, shards
from .kept import kept


def settle_each(client, surfaces: Sequence[Mesh], occluders: Iterable[Mesh] = (), settings: Settling | None = None,
                seed: int = 0, progress: Progress | None = None, cancel: Callable[[], bool] | None = None,
                parts: int | None = None) -> list[Dust]:
    """lamina.dust.settle on each of the surfaces, with all other surfaces and the `occluders` in the way, on the
    cluster of `client`, with the same bytes; `statistics.seconds` is the sum over the parts. `parts`: the number of
    parts of each surface, [1, 4096]; by default the surfaces share four for each thread of the cluster, by their
    numbers of points. The result does not depend on it. Meshes are read in this process, which needs Embree too. Raises
    ExtraMissing without Dask, ArgumentError, and what lamina.dust.settle raises."""
    checked(client)
    if not isinstance(surfaces, Sequence):
        raise ArgumentError(f"surfaces = {quoted(surfaces)}: must be a list of meshes")
    settings = Settling() if settings is None else settings
    check_seed(seed)
    step = stepper("the dust", progress, cancel)
    meshes = [checked_mesh(mesh, f"surfaces[{number}]") for number, mesh in enumerate(surfaces)]
    further = [checked_mesh(mesh, f"occluders[{number}]") for number, mesh in enumerate(occluders)]
    works = []
    for number, mesh in enumerate(meshes):
        step(0.0, f"reading mesh {number + 1} of {len(meshes)}")
        others = [*meshes[:number], *meshes[number + 1:], *further]
        works.append(PartedDust(mesh, others, settings, seed, silent))
    ranges = _ranges(client, [len(work.starts) for work in works], parts)
    shared = (uuid.uuid4().hex, [(work.place, work.starts, work.window) for work in works])
    found = gather(client, _part, [(number, one) for number, own in enumerate(ranges) for one in (*own, None)],
                   shared, "the dust", progress, cancel)
    dusts, before = [], 0
    for work, own in zip(works, ranges, strict=True):
        after = before + len(own)
        dusts.append(work.dust(found[before:after], found[after]))
        before = after + 1
    return dusts


def _ranges(client, counts: list[int], parts: int | None) -> list[list[tuple[int, int]]]:
    """For each surface of that many points, the first point of each part and the point after its last one."""
    ranges = []
    for count in counts:
        wanted = parts
        if parts is None:
            wanted = max(1, round(len(shards(client, None, sum(counts))) * count / sum(counts)))
        number = len(shards(client, wanted, count))
        bounds = [count * place // number for place in range(number + 1)]
        ranges.append(list(zip(bounds[:-1], bounds[1:], strict=True)))
    return ranges


def _part(run: str, works: list, number: int, points: tuple[int, int] | None) -> Any:
    """The rays of the points [first, last) of a surface; None: its grains that are traced from above."""
    place, starts, window = works[number]
    rays = kept((run, number), lambda: Rays(place, 1, silent))
    return rays.grains(window) if points is None else rays.traced(starts.part(*points), points[0], silent)
