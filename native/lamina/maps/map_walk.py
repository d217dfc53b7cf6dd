# SPDX-License-Identifier: GPL-3.0-or-later
"""Walks from each point of a map."""

from __future__ import annotations

import itertools
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
from ..interior.problem import Problem, Run, Samples, TexelImage, WalkPoints
from ..interior.solid import Solid
from ..interior.walk import Walker
from .nearest import everywhere
from .noise import trial
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
    places = replace(places, notes=(*places.notes, *walker.notes))
    places, walker = _open(places, walker)
    places, walker = _with_photons(places, walker, target)
    lamps = 0 if walker.problem.image is None else len(walker.problem.lights.lamps)  # type: ignore[union-attr]
    parts = PartFolder(target.folder, _request(walker, run, lamps, shown))
    counts, pilot = parts.samples or (run.samples and (run.samples, run.samples)), Pilot()
    if not counts:
        few = trial(walker, run.seed, portion(step, 0.5 * SETTING_UP, SETTING_UP))
        counts = few.samples_for(run.noise)
        if run.spread is None:  # other machines have another speed
            pilot = Pilot(few.seconds, few.work, f" for a noise of {100.0 * run.noise:.2g} %")
        if shown is not None:
            first = everywhere(few, places.points)
            shown(MapWalk(places, first, walker, Samples(counts[0], run.seed), silent, began, 0.0))
    parts.begin(counts)
    whole_runs = [Samples(counts[0], run.seed)] + [Samples(counts[1], run.seed, 0, lamps)] * (lamps > 0)
    passes = _passes(whole_runs, shown)
    total = sum(one.count * max(1, one.lamps) for one in whole_runs)

    def passed(found: list[list[WalkPart]]) -> None:
        ended = list(itertools.accumulate(map(len, passes)))
        if shown is not None and len(found) in ended:
            ready = itertools.chain(*passes[:ended.index(len(found)) + 1])
            share = sum(one.count * max(1, one.lamps) for one in ready) / total
            shown(MapWalk(places, merge_passes(found), walker, whole_runs[0], silent, began, share))

    def here(part: tuple[Samples, tuple[int, int]], within: Progress) -> WalkPart:
        return part_of(walker, *part, within)

    done = parts.run(here if run.spread is None else elsewhere(walker.problem),
                     {one: walker.described(one) for one in itertools.chain(*passes)},
                     portion(step, SETTING_UP, 1.0), passed, pilot, run.spread)
    return MapWalk(places, merge_passes(done), walker, whole_runs[0], portion(whole, share, 1.0), began)


def _open(places: Places, walker: Walker) -> tuple[Places, Walker]:
    """Only the places where light can enter. Raises InteriorError."""
    found = walker.is_open()
    if not found.any():
        raise InteriorError("all points of the map lie inside other parts of the mesh or on opaque faces: must lie on "
                            "its outside")
    return (places, walker) if found.all() else (places.only(found), walker.only(found))


def _with_photons(places: Places, walker: Walker, target: Target) -> tuple[Places, Walker]:
    """The places and the walker of an image, with photons for its lamps, unless an eye is given, which photons rarely
    meet, or a lamp inside sends no light through the surface."""
    problem = walker.problem
    if problem.lights is None or not problem.lights.lamps or target.uvs is None or problem.points.views is not None:
        return places, walker
    if problem.boundary.ior == 1.0 and walker.encloses(problem.lights.lamps):
        return places, walker

    def lit(seen: Places, among: Walker) -> tuple[Places, Walker]:
        return seen, among.lit_by_photons(TexelImage(np.asarray(target.uvs, float), seen.mask))

    found = lit(places, walker)
    reached = found[1].texel_areas > 0.0  # a sliver may have less of a texel than rounding errors
    if reached.all():
        return found
    return lit(places.only(reached), walker.only(reached)) if reached.any() else (places, walker)


def _request(walker: Walker, run: Run, lamps: int, shown) -> dict:
    """What identifies a run."""
    found = walker.described(Samples(1, run.seed))
    if lamps:
        photons = walker.described(Samples(1, run.seed, 0, lamps))
        found.update(points=photons["points"], lamps=photons["lamps"])
    del found["samples"]
    wanted = {"noise": run.noise} if run.samples is None else {"samples": run.samples}
    return {**found, **wanted, "previews": shown is not None}


def _passes(runs: list[Samples], shown) -> list[list[Samples]]:
    """The runs in passes. With previews, each pass doubles the number of samples."""
    halvings = 0
    while shown is not None and max(one.count for one in runs) >> halvings >= 2 * LEAST_PASS:
        halvings += 1
    found, ended = [], [0] * len(runs)
    for halving in range(halvings, -1, -1):
        ends = [max(min(LEAST_PASS, one.count), one.count >> halving) for one in runs]
        found.append([replace(one, first=first, count=last - first)
                      for one, first, last in zip(runs, ended, ends, strict=True) if last > first])
        ended = ends
    return found
