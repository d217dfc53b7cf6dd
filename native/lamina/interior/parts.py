# SPDX-License-Identifier: GPL-3.0-or-later
"""Walks in meshes, divided by points into parts. Parts can be saved and merged, so that an interrupted run can be
resumed, or distributed over several machines."""

from __future__ import annotations

import hashlib
import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ..common.archive import Damaged, load_archive, save_archive
from ..common.errors import ShardError, clipped, quoted
from ..common.progress import Progress
from ..walks.shard_parts import checked_shard
from .estimates import COUNTS, ExitEstimate, LightEstimate, exit_estimate, light_estimate
from .lamps import AnyLamp, Surroundings, from_json, to_json
from .walk import Lit, Surface, Walker, checked_lit, start

FORMAT, SCHEMA = "lamina-walks", 2
_ARRAYS = {"exits": ("moments", "products", "counts"), "light": ("sums", "squares", "counts")}
_JOB = ("kind", "solid", "interior", "surface", "points", "count", "lamps", "surroundings", "first", "samples", "seed")


@dataclass(frozen=True, eq=False)
class WalkPart:
    """Part i of n of a run: the sums over the walks from its points. `job` describes the run; all parts of a run have
    the same `job`."""

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
            points = points_of(shard, job["count"])
            shapes = _shapes(job, len(points))
        except (Damaged, TypeError, ValueError, KeyError) as error:
            if isinstance(error, ShardError):
                raise
            raise ShardError(f"{path}: not a whole part of walks") from None
        for name, array, shape in zip(_ARRAYS[job["kind"]], arrays, shapes, strict=True):
            if array.shape != shape or array.dtype != np.float64 or not np.isfinite(array).all():
                raise ShardError(f"{path}: {name} has the shape {array.shape}: must be finite numbers of shape {shape}")
        return cls(job, shard, tuple(arrays))


def walk_in_mesh(solid, interior, points=None, normals=None, directions=None, surface: Surface | None = None,
                 samples: int = 256, seed: int = 0, threads: int = 0, progress: Progress | None = None,
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
    return _whole("exits", solid, interior, points, normals, directions, surface, (), None, samples, seed, threads,
                  progress, cancel)


def light_in_mesh(solid, interior, lamps: Sequence[AnyLamp] = (), points=None, normals=None, directions=None,
                  surface: Surface | None = None, samples: int = 256, seed: int = 0, threads: int = 0,
                  progress: Progress | None = None, cancel: Callable[[], bool] | None = None,
                  surroundings: Surroundings | None = None) -> LightEstimate:
    """The radiance that leaves a closed mesh at points of its surface after transport inside, under lamps and the
    surroundings. The mesh casts shadows on itself, and light that leaves may enter again elsewhere. Lamps cast no
    shadows.

    `lamps`: a list of lamina.Lamp, PointLamp, SpotLamp and AreaLamp. Behind a smooth boundary with an index other than
    1, each Lamp must have an angle of at least 1 degree and other lamps a radius, and noise grows as lamps shrink.
    `surroundings`: a lamina.Surroundings; by default a sky of radiance 1 from all directions. Without `directions` the
    radiance is the cosine-weighted mean over directions. Other arguments and errors are those of
    walk_in_mesh."""
    return _whole("light", solid, interior, points, normals, directions, surface, lamps, surroundings, samples, seed,
                  threads, progress, cancel)


def walk_part(solid, interior, shard: tuple[int, int], lamps: Sequence[AnyLamp] | None = None, points=None,
              normals=None, directions=None, surface: Surface | None = None, samples: int = 256, seed: int = 0,
              threads: int = 0, progress: Progress | None = None, cancel: Callable[[], bool] | None = None,
              surroundings: Surroundings | None = None) -> WalkPart:
    """Part i of n of a run; `shard` = (i, n), i from 1. Without `lamps` this is a part of walk_in_mesh, with `lamps` (a
    list, which may be empty) of light_in_mesh. Merged parts give the same bytes as one run. Raises the same errors."""
    shard = checked_shard(shard)
    kind = "exits" if lamps is None else "light"
    walker, used, step, _ = _started(kind, solid, interior, points, normals, directions, surface, lamps or (),
                                     surroundings, samples, seed, threads, progress, cancel)
    return part_of(job_of(kind, walker, used), shard, walker, used, step)


def merge_walks(parts: Sequence[WalkPart]) -> ExitEstimate | LightEstimate:
    """The estimate from all parts of a run, in any order. Raises ShardError if parts are missing, duplicate, or of
    different runs."""
    job, arrays = _joined(parts)
    return _summary(job, arrays, math.nan)


def merge_passes(passes: Sequence[Sequence[WalkPart]]) -> ExitEstimate | LightEstimate:
    """The estimate from runs that differ only in their samples, each given by all its parts."""
    joined = [_joined(parts) for parts in passes]
    job = {**joined[0][0], "samples": sum(job["samples"] for job, _ in joined)}
    return _summary(job, [sum(arrays[1:], arrays[0]) for arrays in zip(*(found for _, found in joined), strict=True)],
                    math.nan)


def _joined(parts: Sequence[WalkPart]) -> tuple[dict, list[np.ndarray]]:
    """(the run that all parts belong to, its arrays). Raises ShardError."""
    if not isinstance(parts, Sequence) or not parts or not all(isinstance(part, WalkPart) for part in parts):
        raise ShardError(f"parts = {quoted(parts)}: must be a list of at least one lamina.WalkPart")
    job, count = parts[0].job, parts[0].shard[1]
    by_number: dict[int, WalkPart] = {}
    for place, part in enumerate(parts):
        for key in _JOB:
            if part.job[key] != job[key]:
                raise ShardError(f"parts[{place}]: {key} = {quoted(part.job[key])} but {quoted(job[key])} in parts[0]")
        if part.shard[1] != count:
            raise ShardError(f"parts[{place}]: is one of {part.shard[1]} parts, but parts[0] one of {count}")
        if part.shard[0] in by_number:
            raise ShardError(f"parts[{place}]: part {part.shard[0]} of {count} is given twice")
        by_number[part.shard[0]] = part
    missing = [str(number) for number in range(1, count + 1) if number not in by_number]
    if missing:
        raise ShardError(f"part {clipped(', '.join(missing))} of {count} is missing")
    ordered = [by_number[number].arrays for number in range(1, count + 1)]
    return job, [np.concatenate(arrays) for arrays in zip(*ordered, strict=True)]


def points_of(shard: tuple[int, int], count: int) -> range:
    """The points of part (i, n)."""
    number, parts = shard
    return range((number - 1) * count // parts, number * count // parts)


def job_of(kind: str, walker: Walker, lit: Lit) -> dict:
    """The description of a run of this `kind`, "exits" or "light"."""
    return {"kind": kind, "solid": walker.solid_hash, "interior": walker.interior.hash, "points": _points_hash(walker),
            "surface": [walker.surface.ior, walker.surface.alpha, walker.surface.distribution],
            "lamps": [to_json(lamp) for lamp in lit.lamps],
            "surroundings": None if lit.surroundings is None else lit.surroundings.hash,
            "first": walker.first, "samples": walker.samples, "seed": walker.seed, "count": len(walker.positions)}


def part_of(job: dict, shard: tuple[int, int], walker: Walker, lit: Lit, step: Progress) -> WalkPart:
    """Part `shard` of the run of a walker, whose description is `job`."""
    points = points_of(shard, len(walker.positions))
    if job["kind"] == "light":
        arrays = walker.lights(lit, points.start, points.stop, step)
    else:
        arrays = walker.exits(points.start, points.stop, step)[:3]  # no light is late
    return WalkPart(job, shard, tuple(arrays))


def _whole(kind, *given):
    walker, lit, step, seconds = _started(kind, *given)
    part = part_of(job_of(kind, walker, lit), (1, 1), walker, lit, step)
    step(1.0, "Done")
    return _summary(part.job, list(part.arrays), seconds())


def _started(kind, solid, interior, points, normals, directions, surface, lamps, surroundings, samples, seed, threads,
             progress, cancel):
    """(walker, Lit, step, a function that returns the elapsed seconds)."""
    surface = Surface() if surface is None else surface

    def checked():
        return checked_lit(lamps, surroundings, surface) if kind == "light" else Lit()

    return start(solid, interior, surface, points, normals, directions, samples, seed, threads, progress, cancel,
                 checked)


def _points_hash(walker: Walker) -> str:
    digest = hashlib.sha256()
    for array in (walker.positions, walker.normals, walker.views):
        digest.update(b"-" if array is None else np.ascontiguousarray(array).data)
    return digest.hexdigest()


def _summary(job: dict, arrays: list[np.ndarray], seconds: float) -> ExitEstimate | LightEstimate:
    first, second, counts = arrays
    if job["kind"] == "exits":
        return exit_estimate(first, second, counts, job["samples"], seconds)
    lamps = tuple(from_json(one) for one in job["lamps"])
    return light_estimate(first, second, counts, job["samples"], lamps, seconds)


def _shapes(job: dict, points: int) -> tuple:
    counts = (points, len(COUNTS))
    if job["kind"] == "exits":
        return (points, 3, 3), (points, 3, 6), counts
    columns = len(job["lamps"]) + 1
    return (points, columns, 3), (points, columns, 3), counts
