# SPDX-License-Identifier: GPL-3.0-or-later
"""Walks from each point of a map."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..common.arguments import check_callable, check_whole, finite_array
from ..common.errors import ArgumentError, InteriorError
from ..common.progress import Progress, portion, silent
from ..interior.estimates import ExitEstimate, LightEstimate
from ..interior.parts import WalkPart, elsewhere, merge_passes, part_of
from ..interior.problem import Problem, Run, Samples, WalkPoints
from ..interior.solid import Solid
from ..interior.walk import Walker
from .nearest import everywhere
from .noise import TRIAL_SAMPLES, trial
from .part_folder import PartFolder, Pilot
from .places import Places, places_of

MOST_MARGIN = 64
SETTING_UP = 0.1  # share of the progress
LEAST_PASS = 4  # samples of the first pass


@dataclass(frozen=True, eq=False)
class Target:
    """What a map is made of: `uvs` and `size` of an image, or vertices; shading `normals`; the `margin` in texels; and
    `view` or `eye`, see lit_images. `folder`: keeps finished parts. Raises ArgumentError."""

    uvs: np.ndarray | None
    size: int | tuple[int, int] | None
    normals: np.ndarray | None
    margin: int
    folder: str | os.PathLike | None
    view: np.ndarray | None = None
    eye: np.ndarray | None = None

    def __post_init__(self):
        check_whole(self.margin, "margin", 0, MOST_MARGIN)

    def points(self, solid: Solid) -> tuple[Places, WalkPoints]:
        """Raises InteriorError, ArgumentError."""
        places = places_of(solid, self.uvs, self.size, self.normals)
        directions = self._directions(places.points.positions)
        if directions is not None:
            places, directions = places.facing(directions)
        return places, WalkPoints.of(places.points.positions, places.points.normals, directions)

    def _directions(self, positions: np.ndarray) -> np.ndarray | None:
        """Directions to the eye, or None for the mean over directions."""
        if self.view is not None and self.eye is not None:
            raise ArgumentError("view and eye are both given: give a direction, or a position, or neither")
        if self.view is None and self.eye is None:
            return None
        name, value = ("view", self.view) if self.eye is None else ("eye", self.eye)
        array = finite_array(value, name)
        if array.shape != (3,) or (self.eye is None and not array.any()):
            rule = "three numbers, not all 0" if self.eye is None else "three lengths in mm"
            raise ArgumentError(f"{name} = {value!r}: must be {rule}")
        return np.broadcast_to(array, positions.shape) if self.eye is None else array - positions


@dataclass(frozen=True, eq=False)
class MapWalk:
    """The points of a map and the estimates there. `samples`: of all walks. `step`: for further work, the rest of the
    progress. `done`: share of the samples, below 1 for a preview; 0 for the interpolated estimates of a trial at few
    points."""

    places: Places
    estimate: ExitEstimate | LightEstimate
    walker: Walker
    samples: Samples
    step: Progress
    began: float
    done: float = 1.0


def map_of(problem: Problem, target: Target, run: Run, image: Callable, preview: Callable | None, share: float = 1.0):
    """`image(walked, margin)` of the walks that solve a problem at the points of a target; with `preview`, it is called
    with such images of the walks so far. `share`: of the progress, the rest is for further work. Raises ArgumentError,
    InteriorError, ShardError, OSError, Cancelled, DustUnavailable."""
    check_callable(preview, "preview")
    shown = None if preview is None else lambda walked: preview(image(walked, target.margin))
    walked = _walked(problem, target, run, shown, share)
    found = image(walked, target.margin)
    walked.step(1.0, "Done")
    return found


def _walked(problem: Problem, target: Target, run: Run, shown: Callable[[MapWalk], None] | None,
            share: float) -> MapWalk:
    began = time.perf_counter()
    whole = run.stepper("the map")
    step = portion(whole, 0.0, share)
    places, points = target.points(problem.solid)
    walker = Walker(replace(problem, points=points), run.threads, portion(step, 0.0, 0.5 * SETTING_UP))
    open_places = walker.is_open()
    if not open_places.all():
        if not open_places.any():
            raise InteriorError("all points of the map lie inside other parts of the mesh or on opaque faces: must lie "
                                "on its outside")
        places, walker = places.only(open_places), walker.only(open_places)
    described = walker.described(Samples(1, run.seed))
    wanted = {"noise": run.noise} if run.samples is None else {"samples": run.samples}
    wanted["previews"] = shown is not None
    parts = PartFolder(target.folder, {**{key: described[key] for key in described if key != "samples"}, **wanted})
    count, pilot = parts.samples or run.samples, Pilot()
    if count is None:
        few = trial(walker, run.seed, portion(step, 0.5 * SETTING_UP, SETTING_UP))
        count = few.samples_for(run.noise)
        if run.spread is None:  # other machines have another speed
            pilot = Pilot(few.seconds, TRIAL_SAMPLES * len(few.chosen) / described["count"],
                          f" for a noise of {100.0 * run.noise:.2g} %")
        if shown is not None:
            first = everywhere(few, places.points)
            shown(MapWalk(places, first, walker, Samples(count, run.seed), silent, began, 0.0))
    parts.begin(count)
    samples = Samples(count, run.seed)
    passes = [Samples(last - first, run.seed, first) for first, last in _passes(count, shown)]

    def passed(found: list[list[WalkPart]]) -> None:
        if shown is not None:
            ready = sum(one.count for one in passes[:len(found)]) / count
            shown(MapWalk(places, merge_passes(found), walker, samples, silent, began, ready))

    def here(part: tuple[Samples, tuple[int, int]], within: Progress) -> WalkPart:
        return part_of(walker, *part, within)

    done = parts.run(here if run.spread is None else elsewhere(walker.problem),
                     {one: walker.described(one) for one in passes}, portion(step, SETTING_UP, 1.0), passed, pilot,
                     run.spread)
    return MapWalk(places, merge_passes(done), walker, samples, portion(whole, share, 1.0), began)


def _passes(samples: int, shown) -> list[tuple[int, int]]:
    """(first sample, first sample of the next pass) for each pass. With previews, each pass doubles the number of
    samples."""
    ends = [samples]
    while shown is not None and ends[0] >= 2 * LEAST_PASS:
        ends.insert(0, ends[0] // 2)
    return list(zip([0, *ends[:-1]], ends, strict=True))
