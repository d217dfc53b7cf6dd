# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a map's walks on other machines."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..common.progress import Progress, silent
from ..interior.grid import Interior
from ..interior.parts import WalkPart, part_of
from ..interior.solid import Solid
from ..interior.walk import Lit, Surface, Walker
from ..settling.mesh import Points


@dataclass(frozen=True, eq=False)
class WalkTask:
    """What the parts of a run are made from. `job` describes the run, see lamina.interior.parts.job_of. `directions`:
    towards the eye, or None. `lit`: lamps and surroundings."""

    job: dict
    solid: Solid
    interior: Interior
    surface: Surface
    points: Points
    directions: np.ndarray | None
    lit: Lit

    def walker(self) -> Walker:
        """The walker of this run and of runs that differ in their samples, for one thread."""
        return Walker(self.solid, self.interior, self.surface, self.points.positions, self.points.normals,
                      self.directions, 1, self.job["seed"], 1, silent)

    def part(self, shard: tuple[int, int], walker: Walker, step: Progress = silent) -> WalkPart:
        """Part `shard` of this run, by a walker of the run or of one that differs in its samples."""
        own = walker.with_samples(self.job["first"], self.job["samples"])
        return part_of(self.job, shard, own, self.lit, step)


# spread(task, parts, function that keeps a part, progress)
Spread = Callable[[WalkTask, list[tuple[int, int]], Callable[[WalkPart], None], Progress], None]
