# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of maps of an interior on a Dask cluster."""

from __future__ import annotations

from collections.abc import Callable

from ..common.progress import Progress
from ..interior.parts import WalkPart
from ..maps.spread import Spread, WalkTask
from .gather import checked, gather
from .kept import kept


def spread(client) -> Spread:
    """The argument `spread` of lamina.relightable_images and lamina.lit_images: the parts of the walks are computed on
    the cluster of `client`, with the bytes of one process. The short trial that finds the number of samples, and the
    work after the walks, stay in this process. Finished parts are kept in `folder`, as without a cluster. Raises
    ExtraMissing without Dask, and ArgumentError."""
    checked(client)

    def run(task: WalkTask, shards: list[tuple[int, int]], keep: Callable[[WalkPart], None], step: Progress) -> None:
        gather(client, _part, [(one,) for one in shards], (task,), "the map", step, None, keep)

    return run


def _part(task: WalkTask, shard: tuple[int, int]) -> WalkPart:
    run = {name: value for name, value in task.job.items() if name not in ("first", "samples")}
    return task.part(shard, kept(run, task.walker))
