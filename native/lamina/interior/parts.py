# SPDX-License-Identifier: GPL-3.0-or-later
"""Walks in meshes, divided by points into parts. Parts can be saved and merged, so that an interrupted run can be
resumed, or distributed over several machines."""

from __future__ import annotations

import functools
import math
import os
import time
import uuid
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from ..common.archive import Damaged, load_archive, save_archive
from ..common.arguments import check_path
from ..common.errors import ShardError, quoted
from ..common.kept import kept
from ..common.parts import checked_shard, in_sequence, share_of
from ..common.progress import Progress, portion, silent
from .estimates import COUNTS, NUMBERS, ExitEstimate, LightEstimate, exit_estimate, light_estimate, with_photons
from .lamps import AnyLamp, Surroundings, from_json
from .occluders import Occluders
from .problem import SPLIT_PHOTONS, Lights, Problem, Run, Samples, Surface, WalkPoints
from .walk import Walker

FORMAT, SCHEMA = "lamina-walks", 4
WORK = "the walk in the mesh"
_ARRAYS = {"exits": ("moments", "products", "counts"), "light": ("sums", "squares", "counts"),
           SPLIT_PHOTONS: ("sums", "squares", "counts")}
_JOB = ("kind", "solid", "interior", "surface", "points", "count", "lamps", "surroundings", "first", "samples", "seed")


@dataclass(frozen=True, eq=False)
class WalkPart:
    """Part i of n of a run: the sums over the walks from its points, or at all points over its photons. `job` describes
    the run; all parts of a run have the same `job`."""

    job: dict
    shard: tuple[int, int]
    arrays: tuple[np.ndarray, ...]

    def save(self, path: str | os.PathLike) -> None:
        """Writes an .npz file atomically. Raises OSError."""
        header = {"format": FORMAT, "schema": SCHEMA, "job": self.job, "shard": list(self.shard)}
        save_archive(path, header, **dict(zip(_ARRAYS[self.job["kind"]], self.arrays, strict=True)))

    @classmethod
    def load(cls, path: str | os.PathLike) -> WalkPart:
        """Reads a part. Raises ShardError if the file is truncated, damaged or not a part. Raises OSError if the file
        cannot be opened."""
        path = check_path(path)
        try:
            header, _ = load_archive(path)
            if not isinstance(header, dict) or header.get("format") != FORMAT:
                raise Damaged
            if header.get("schema") != SCHEMA:
                raise ShardError(f"{path}: schema = {quoted(header.get('schema'))}: must be {SCHEMA}")
            job = header.get("job")
            if not isinstance(job, dict) or set(job) != set(_JOB) or job["kind"] not in _ARRAYS:
                raise Damaged
            _, arrays = load_archive(path, *_ARRAYS[job["kind"]])
            shard = checked_shard(header["shard"])
            shapes = _shapes(job, shard)
        except (Damaged, TypeError, ValueError, KeyError) as error:
            if isinstance(error, ShardError):
                raise
            raise ShardError(f"{path}: not a whole part of walks") from None
        for name, array, shape in zip(_ARRAYS[job["kind"]], arrays, shapes, strict=True):
            if array.shape != shape or array.dtype != np.float64 or not np.isfinite(array).all():
                raise ShardError(f"{path}: {name} has the shape {array.shape}: must be finite numbers of shape {shape}")
        return cls(job, shard, tuple(arrays))


def walk_in_mesh(solid, interior, points=None, normals=None, directions=None, surface: Surface | None = None,
                 samples: int = 256, seed: int = 0, *, threads: int = 0, progress: Progress | None = None,
                 cancel: Callable[[], bool] | None = None) -> ExitEstimate:
    """Exit albedo and exit distance of light that enters a closed mesh at points of its surface. By reciprocity the
    exit albedo is also the light that leaves at these points when the entire surface is uniformly lit.

    `solid`: a lamina.Solid in mm; `interior`: a lamina.Interior; `surface`: a lamina.Surface, the boundary, by default
    matched. `points`, `normals`: (n, 3) each, at most 1e-4 of the mesh's size off a face; default: the vertices of the
    solid. `directions`: (n, 3) or (3,), towards the eye; light enters against these directions. By default light enters
    from all directions with the flux of a uniform sky. `samples`: samples per point, up to 2^32; each has three walks,
    one for each channel.
    The same seed gives the same numbers for any number of `threads` (0: all). `progress(fraction, text)` reports
    progress. `cancel()` is called often; if it returns true, Cancelled is raised. Also raises InteriorError and
    ArgumentError (both are ValueErrors), and DustUnavailable without a working Embree.
    Method: delta tracking with a majorant for each brick of voxels (Woodcock et al. 1965); walks serve all channels
    only where the channels have equal extinctions; unlimited path length. Faces are flat: interpolated normals are
    used only at the start of a walk."""
    problem = Problem(solid, interior, surface, None, WalkPoints.of(points, normals, directions))
    run = Run(samples, seed=seed, threads=threads, progress=progress, cancel=cancel)
    return cast(ExitEstimate, estimated(problem, run))


def light_in_mesh(solid, interior, lamps: Sequence[AnyLamp] = (), points=None, normals=None, directions=None,
                  surface: Surface | None = None, samples: int = 256, *, seed: int = 0, threads: int = 0,
                  progress: Progress | None = None, cancel: Callable[[], bool] | None = None,
                  surroundings: Surroundings | None = None, occluders: Occluders | None = None) -> LightEstimate:
    """The radiance that leaves a closed mesh at points of its surface after transport inside, under lamps and the
    surroundings. The mesh and the `occluders` cast shadows, and light that leaves may enter again elsewhere, also
    after reflection by occluders. Lamps cast no shadows.

    `lamps`: a list of lamina.Lamp, PointLamp, SpotLamp and AreaLamp. Behind a smooth boundary with an index other than
    1, each Lamp must have an angle of at least 1 degree and other lamps a radius, and noise grows as lamps shrink.
    `surroundings`: a lamina.Surroundings; by default a sky of radiance 1 from all directions. Without `directions` the
    radiance is the cosine-weighted mean over directions. Other arguments and errors are those of
    walk_in_mesh."""
    lights = Lights(lamps, surroundings, occluders)
    problem = Problem(solid, interior, surface, lights, WalkPoints.of(points, normals, directions))
    run = Run(samples, seed=seed, threads=threads, progress=progress, cancel=cancel)
    return cast(LightEstimate, estimated(problem, run))


def walk_part(solid, interior, shard: tuple[int, int], lamps: Sequence[AnyLamp] | None = None, points=None,
              normals=None, directions=None, surface: Surface | None = None, *, samples: int = 256, seed: int = 0,
              threads: int = 0, progress: Progress | None = None, cancel: Callable[[], bool] | None = None,
              surroundings: Surroundings | None = None, occluders: Occluders | None = None) -> WalkPart:
    """Part i of n of a run; `shard` = (i, n), i from 1. Without `lamps` this is a part of walk_in_mesh, with `lamps` (a
    list, which may be empty) of light_in_mesh. Merged parts give the same bytes as one run. Raises the same errors."""
    shard = checked_shard(shard)
    lights = None if lamps is None else Lights(lamps, surroundings, occluders)
    problem = Problem(solid, interior, surface, lights, WalkPoints.of(points, normals, directions))
    return _part(problem, Run(samples, seed=seed, threads=threads, progress=progress, cancel=cancel), shard)


def estimated(problem: Problem, run: Run) -> ExitEstimate | LightEstimate:
    """The estimate of a problem. Raises the errors of walk_in_mesh."""
    began = time.perf_counter()
    part = _part(problem, run, (1, 1))
    run.stepper(WORK)(1.0, "Done")
    return _summary(part.job, list(part.arrays), time.perf_counter() - began)


def merge_walks(parts: Sequence[WalkPart]) -> ExitEstimate | LightEstimate:
    """The estimate from all parts of a run, in any order. Raises ShardError if parts are missing, duplicate, or of
    different runs."""
    return merge_passes([parts])


def merge_passes(runs: Sequence[Sequence[WalkPart]]) -> ExitEstimate | LightEstimate:
    """The estimate from runs that differ only in their samples, each given by all its parts. Of runs of photons and of
    walks, the estimate of all lights."""
    photons = [parts for parts in runs if isinstance(parts, Sequence) and parts and _of_photons(parts[0])]
    found = _summary(*_added([parts for parts in runs if parts not in photons]), math.nan)
    if not photons:
        return found
    job, arrays = _added(photons)
    return with_photons(cast(LightEstimate, found), arrays, job["samples"] * job["count"], _lamps(job))


def _of_photons(part: WalkPart) -> bool:
    return isinstance(part, WalkPart) and part.job["kind"] == SPLIT_PHOTONS


def _added(runs: Sequence[Sequence[WalkPart]]) -> tuple[dict, list[np.ndarray]]:
    """(the description, the sums) of runs of one kind."""
    joined = [_joined(parts) for parts in runs]
    job = {**joined[0][0], "samples": sum(job["samples"] for job, _ in joined)}
    return job, [sum(arrays[1:], arrays[0]) for arrays in zip(*(found for _, found in joined), strict=True)]


def part_of(walker: Walker, samples: Samples, shard: tuple[int, int], step: Progress = silent) -> WalkPart:
    """Part `shard` of the run of a walker with these samples."""
    job = walker.described(samples)
    if samples.lamps:
        sent = share_of(shard, samples.count * job["count"])
        return WalkPart(job, shard, tuple(walker.photons(samples, step, sent)))
    points = share_of(shard, job["count"])
    walk = walker.exits if walker.problem.lights is None else walker.lights
    return WalkPart(job, shard, tuple(walk(samples, step, points)[:3]))  # no light is late


def elsewhere(problem: Problem) -> Callable[[Any], WalkPart]:
    """A function of (samples, shard) for other machines: the part of a run of this problem, by one thread."""
    return functools.partial(_elsewhere, uuid.uuid4().hex, problem)


def _elsewhere(run: str, problem: Problem, part: tuple[Samples, tuple[int, int]]) -> WalkPart:
    return part_of(kept(run, lambda: Walker(problem, 1, silent)), *part)


def _part(problem: Problem, run: Run, shard: tuple[int, int]) -> WalkPart:
    step = run.stepper(WORK)
    walker = Walker(problem, run.threads, portion(step, 0.0, 0.1))
    return part_of(walker, Samples(cast(int, run.samples), run.seed), shard, portion(step, 0.1, 1.0))


def _joined(parts: Sequence[WalkPart]) -> tuple[dict, list[np.ndarray]]:
    """(the run that all parts belong to, its arrays). Raises ShardError."""
    if not isinstance(parts, Sequence) or not parts or not all(isinstance(part, WalkPart) for part in parts):
        raise ShardError(f"parts = {quoted(parts)}: must be a list of at least one lamina.WalkPart")
    order = in_sequence([part.job for part in parts], [part.shard for part in parts],
                        [f"parts[{place}]" for place in range(len(parts))])
    together = zip(*(parts[place].arrays for place in order), strict=True)
    if _of_photons(parts[0]):
        return parts[0].job, [sum(arrays[1:], arrays[0]) for arrays in together]
    return parts[0].job, [np.concatenate(arrays) for arrays in together]


def _summary(job: dict, arrays: list[np.ndarray], seconds: float) -> ExitEstimate | LightEstimate:
    first, second, counts = arrays
    if job["kind"] == "exits":
        return exit_estimate(first, second, counts, job["samples"], seconds)
    return light_estimate(first, second, counts, job["samples"], _lamps(job), seconds)


def _lamps(job: dict) -> tuple[AnyLamp, ...]:
    return tuple(from_json(one) for one in job["lamps"])


def _shapes(job: dict, shard: tuple[int, int]) -> tuple:
    if job["kind"] == SPLIT_PHOTONS:
        lit = (job["count"], len(job["lamps"]), NUMBERS)
        return lit, lit, (len(job["lamps"]), len(COUNTS))
    points = len(share_of(shard, job["count"]))
    counts = (points, len(COUNTS))
    if job["kind"] == "exits":
        return (points, 3, 3), (points, 3, 6), counts
    columns = len(job["lamps"]) + 1
    return (points, columns, NUMBERS), (points, columns, NUMBERS), counts
