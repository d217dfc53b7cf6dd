# SPDX-License-Identifier: GPL-3.0-or-later
"""Walks from each point of a map."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..common.arguments import check_field, check_whole, finite_array
from ..common.errors import ArgumentError, InteriorError
from ..common.progress import Progress, portion, silent, stepper
from ..interior.estimates import ExitEstimate, LightEstimate
from ..interior.grid import Interior
from ..interior.parts import WalkPart, job_of, merge_passes
from ..interior.solid import Solid
from ..interior.walk import MOST_SAMPLES, Lit, Surface, Walker, checked_lit
from ..kinds.interiors import NOISE
from .coarse import everywhere
from .noise import TRIAL_SAMPLES, trial
from .part_folder import PartFolder, Pilot
from .places import Places, places_of
from .spread import Spread, WalkTask

SETTING_UP = 0.1  # share of the progress
LEAST_PASS = 4  # samples of the first pass


@dataclass(frozen=True, eq=False)
class MapWalk:
    """The points of a map and the estimates there. `step`: for further work, the rest of the progress. `done`: share of
    the samples, below 1 for a preview; 0 for the interpolated estimates of a trial at few points."""

    places: Places
    estimate: ExitEstimate | LightEstimate
    walker: Walker
    step: Progress
    began: float
    done: float = 1.0


@dataclass(frozen=True, eq=False)
class MapJob:
    """What both kinds of maps are made from. See relightable_images and lit_images."""

    solid: Solid
    interior: Interior
    uvs: np.ndarray | None
    size: int | tuple[int, int] | None
    surface: Surface | None
    normals: np.ndarray | None
    noise: float
    samples: int | None
    seed: int
    folder: str | os.PathLike | None
    threads: int
    progress: Progress | None
    cancel: Callable[[], bool] | None
    spread: Spread | None = None
    """Computes the parts on other machines."""
    shown: Callable[[MapWalk], None] | None = None
    """Is called with previews."""


def walk_map(job: MapJob, kind: str, lamps=(), surroundings=None, view=None, eye=None, share: float = 1.0) -> MapWalk:
    """Estimates of this `kind`, "exits" or "light". `lamps`, `surroundings`, `view`, `eye`: see lit_images. `share`: of
    the progress, the rest is for further work. Raises ArgumentError, InteriorError, ShardError, OSError, Cancelled,
    DustUnavailable."""
    began = time.perf_counter()
    whole = stepper("the map", job.progress, job.cancel)
    step = portion(whole, 0.0, share)
    check_field(job.noise, NOISE)
    if job.samples is not None:
        check_whole(job.samples, "samples", 1, MOST_SAMPLES, "must be a whole number from 1 to 2^32, or None")
    surface = Surface() if job.surface is None else job.surface
    if not isinstance(surface, Surface):
        raise ArgumentError(f"surface = {type(surface).__name__}: must be a lamina.Surface")
    used = checked_lit(lamps, surroundings, surface) if kind == "light" else Lit()
    places = places_of(job.solid, job.uvs, job.size, job.normals)
    directions = _directions(places.points.positions, view, eye)
    if directions is not None:
        places, directions = places.facing(directions)
    points = places.points
    walker = Walker(job.solid, job.interior, surface, points.positions, points.normals, directions, job.samples or 1,
                    job.seed, job.threads, portion(step, 0.0, 0.5 * SETTING_UP))
    open_places = walker.is_open()
    if not open_places.all():
        if not open_places.any():
            raise InteriorError("all points of the map lie inside other parts of the mesh or on opaque faces: must lie "
                                "on its outside")
        places, walker = places.only(open_places), walker.with_points(open_places, walker.samples, job.seed)
        points, directions = places.points, None if directions is None else directions[open_places]
    described = job_of(kind, walker, used)
    wanted = {"noise": job.noise} if job.samples is None else {"samples": job.samples}
    wanted["previews"] = job.shown is not None
    parts = PartFolder(job.folder, {**{key: described[key] for key in described if key != "samples"}, **wanted})

    def show(estimate, done: float) -> None:
        if job.shown is not None:
            job.shown(MapWalk(places, estimate, walker, silent, began, done))

    walks, pilot = parts.samples or job.samples, Pilot()
    if walks is None:
        few = trial(kind, walker, used, portion(step, 0.5 * SETTING_UP, SETTING_UP))
        walks = few.samples_for(job.noise)
        if job.spread is None:  # other machines have another speed
            pilot = Pilot(few.seconds, TRIAL_SAMPLES * len(few.chosen) / len(points.positions),
                          f" for a noise of {100.0 * job.noise:.2g} %")
        if job.shown is not None:
            show(everywhere(few, places.points), 0.0)
    parts.begin(walks)
    walker.samples = walks
    passes = [{**described, "first": first, "samples": last - first} for first, last in _passes(walks, job.shown)]

    def compute(one: dict, shards: list[tuple[int, int]], keep: Callable[[WalkPart], None], within: Progress) -> None:
        task = WalkTask(one, job.solid, job.interior, surface, points, directions, used)
        if job.spread is not None:
            job.spread(task, shards, keep, within)
            return
        for place, shard in enumerate(shards):
            keep(task.part(shard, walker, portion(within, place / len(shards), (place + 1) / len(shards))))

    done = parts.run(passes, compute, portion(step, SETTING_UP, 1.0), lambda found: show(
        merge_passes(found), (passes[len(found) - 1]["first"] + passes[len(found) - 1]["samples"]) / walks), pilot)
    return MapWalk(places, merge_passes(done), walker, portion(whole, share, 1.0), began)


def _passes(samples: int, shown) -> list[tuple[int, int]]:
    """(first sample, first sample of the next pass) for each pass. With previews, each pass doubles the number of
    samples."""
    ends = [samples]
    while shown is not None and ends[0] >= 2 * LEAST_PASS:
        ends.insert(0, ends[0] // 2)
    return list(zip([0, *ends[:-1]], ends, strict=True))


def _directions(positions: np.ndarray, view, eye) -> np.ndarray | None:
    """Directions to the eye, or None for the mean over directions. Raises ArgumentError."""
    if view is not None and eye is not None:
        raise ArgumentError("view and eye are both given: give a direction, or a position, or neither")
    if view is None and eye is None:
        return None
    name, value = ("view", view) if eye is None else ("eye", eye)
    array = finite_array(value, name)
    if array.shape != (3,) or (eye is None and not array.any()):
        rule = "three numbers, not all 0" if eye is None else "three lengths in mm"
        raise ArgumentError(f"{name} = {value!r}: must be {rule}")
    return np.broadcast_to(array, positions.shape) if eye is None else array - positions
