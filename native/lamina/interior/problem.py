# SPDX-License-Identifier: GPL-3.0-or-later
"""A problem of light in a body, and how its walks run."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace

import numpy as np

from ..common.arguments import (
    check_choice,
    check_field,
    check_kind,
    check_seed,
    check_threads,
    check_whole,
    finite_array,
)
from ..common.errors import ArgumentError, quoted
from ..common.progress import Progress, stepper
from ..kinds.boundaries import ALPHA, DISTRIBUTION, IOR
from ..kinds.interiors import NOISE
from ..settling.mesh import Mesh, checked_mesh, vertex_points
from .grid import Interior
from .lamps import KINDS, AnyLamp, Surroundings, to_json
from .occluders import Occluders
from .solid import Solid

MOST_SAMPLES = 1 << 32
SPLIT_PHOTONS = "split photons"  # a kind of run; earlier ones, "photons", were not split in dark parts


@dataclass(frozen=True)
class Surface:
    """The boundary of a solid in air. `ior`: refractive index of the solid, [1, 4]; 1: no boundary. `alpha`: width of
    the microfacet distribution, [0, 1]; 0: smooth. `distribution`: "ggx" or "beckmann". Raises ArgumentError."""

    ior: float = 1.0
    alpha: float = 0.0
    distribution: str = "ggx"

    def __post_init__(self):
        for field in (IOR, ALPHA):
            object.__setattr__(self, field.name, check_field(getattr(self, field.name), field))
        check_choice(self.distribution, DISTRIBUTION.name, DISTRIBUTION.values)

    @property
    def is_smooth(self) -> bool:
        return self.alpha == 0.0 and self.ior != 1.0


@dataclass(frozen=True)
class Lights:
    """The sources of light: lamps, and the surroundings; None: radiance 1 from all directions. `occluders`: what casts
    shadows on the solid, None: nothing. `by_occluders`: of the light of lamps, only that which meets an occluder
    first. Raises ArgumentError."""

    lamps: Sequence[AnyLamp] = ()
    surroundings: Surroundings | None = None
    occluders: Occluders | None = None
    by_occluders: bool = False

    def __post_init__(self):
        kinds = tuple(KINDS.values())
        if not isinstance(self.lamps, Sequence) or not all(isinstance(one, kinds) for one in self.lamps):
            names = ", ".join(f"lamina.{kind.__name__}" for kind in kinds)
            raise ArgumentError(f"lamps = {quoted(self.lamps)}: must be a list of {names}")
        object.__setattr__(self, "lamps", tuple(self.lamps))
        if self.surroundings is not None:
            check_kind(self.surroundings, "surroundings", Surroundings, "a lamina.Surroundings")
        if self.occluders is not None:
            check_kind(self.occluders, "occluders", Occluders, "a lamina.Occluders")


@dataclass(frozen=True, eq=False)
class WalkPoints:
    """Points of a surface from which walks start, made by `of`: (n, 3) each, positions in mm, unit normals, and unit
    directions to the eye, or None for means over directions. Without positions: the vertices of the solid."""

    positions: np.ndarray = None  # type: ignore[assignment]  # only until `on` is called
    normals: np.ndarray = None  # type: ignore[assignment]
    views: np.ndarray | None = None

    @classmethod
    def of(cls, positions, normals, directions=None) -> WalkPoints:
        """Checked points. `directions`: (n, 3) or (3,), of any length, out of the surface. Raises ArgumentError."""
        if positions is None:
            if normals is not None:
                raise ArgumentError("normals are given without points: must be given together")
            return cls(views=directions)
        positions, normals = _rows(positions, "points"), _unit_rows(normals, "normals")
        if len(normals) != len(positions):
            raise ArgumentError(f"normals has {len(normals)} rows: must have {len(positions)} like points")
        if directions is None:
            return cls(positions, normals)
        views = _directions(directions, len(positions))
        inward = np.flatnonzero((views * normals).sum(axis=1) <= 0.0)
        if len(inward):
            raise ArgumentError(f"directions[{inward[0]}] points into the solid: must point to the eye, outwards")
        return cls(positions, normals, views)

    def on(self, solid: Solid) -> WalkPoints:
        """These points, or the vertices of a checked solid."""
        if self.positions is not None:
            return self
        found = vertex_points(checked_mesh(Mesh(solid.vertices, solid.triangles), "solid"))
        points = WalkPoints.of(found.positions, found.normals)
        return points if self.views is None else replace(points, views=_directions(self.views, len(found.positions)))

    def only(self, chosen) -> WalkPoints:
        """The chosen ones of given points: a slice, indices or booleans."""
        views = None if self.views is None else self.views[chosen]
        return WalkPoints(self.positions[chosen], self.normals[chosen], views)

    @property
    def hash(self) -> str:
        return _hash_of(self.positions, self.normals, self.views)


@dataclass(frozen=True, eq=False)
class TexelImage:
    """An image over a UV map. `uvs`: (triangles, 3, 2), of the given solid. `mask`: (height, width), rows from the
    bottom, which texels have a point of a problem, in sequence."""

    uvs: np.ndarray
    mask: np.ndarray

    @property
    def hash(self) -> str:
        return _hash_of(self.uvs, self.mask)


@dataclass(frozen=True, eq=False)
class Problem:
    """What is asked of the light in a body: `lights` shine on it, and light that leaves is wanted at `points`. Without
    `lights`, light enters at the points, and the place where it leaves is wanted. `surface`: by default matched.
    `image`: the points are those of its texels, to which photons bring the light of lamps, as means over directions and
    the texels' surface; without it, walks from the points find the lamps. Raises ArgumentError; the solid is checked by
    the Walker."""

    solid: Solid
    interior: Interior
    surface: Surface | None = None
    lights: Lights | None = None
    points: WalkPoints = WalkPoints()
    image: TexelImage | None = None

    def __post_init__(self):
        check_kind(self.interior, "interior", Interior, "a lamina.Interior")
        check_kind(self.boundary, "surface", Surface, "a lamina.Surface")
        for number, lamp in enumerate(() if self.lights is None else self.lights.lamps):
            if self.boundary.is_smooth and lamp.too_small:
                raise ArgumentError(f"lamps[{number}].{lamp.too_small} behind a smooth boundary, or alpha above 0")

    @property
    def boundary(self) -> Surface:
        return Surface() if self.surface is None else self.surface

    @property
    def lit_by_walks(self) -> Lights:
        """The sources that walks from the points find."""
        lights = Lights() if self.lights is None else self.lights
        if self.image is None:
            return lights
        return replace(lights, lamps=() if lights.occluders is None else lights.lamps, by_occluders=True)

    @functools.cached_property
    def described(self) -> dict:
        """What walks from the points depend on except for the solid and the samples; of given points."""
        lights = self.lit_by_walks
        around = {} if lights.occluders is None else {"occluders": [lights.occluders.hash, lights.by_occluders]}
        return {"kind": "exits" if self.lights is None else "light", "interior": self.interior.hash,
                "points": self.points.hash, "count": len(self.points.positions),
                "surface": [self.boundary.ior, self.boundary.alpha, self.boundary.distribution],
                "lamps": [to_json(lamp) for lamp in lights.lamps],
                "surroundings": None if lights.surroundings is None else lights.surroundings.hash, **around}

    @functools.cached_property
    def described_photons(self) -> dict:
        """The same of photons for the image."""
        lamps, image = self.lights.lamps, self.image  # type: ignore[union-attr]  # photons have both
        return {**self.described, "kind": SPLIT_PHOTONS, "points": self.points.hash + image.hash,  # type: ignore[union-attr]
                "lamps": [to_json(lamp) for lamp in lamps], "surroundings": None}


@dataclass(frozen=True)
class Samples:
    """Samples [first, first + count) of each point, with the random numbers of a seed. `lamps`: 0 for walks from the
    points; otherwise the number of lamps of which each sends as many photons per point. Raises ArgumentError."""

    count: int
    seed: int = 0
    first: int = 0
    lamps: int = 0

    def __post_init__(self):
        check_whole(self.count, "samples", 1, MOST_SAMPLES, "must be a whole number from 1 to 2^32")
        check_seed(self.seed)


@dataclass(frozen=True, eq=False)
class Run:
    """How walks run. `samples`: per point; None in maps, where a trial finds the number for the standard error `noise`,
    relative to the mean. `threads`: 0 for all. `spread`: an executor that computes the parts. Raises ArgumentError."""

    samples: int | None = 256
    noise: float = 0.02
    seed: int = 0
    threads: int = 0
    progress: Progress | None = None
    cancel: Callable[[], bool] | None = None
    spread: Executor | None = None

    def __post_init__(self):
        check_seed(self.seed)
        check_threads(self.threads)
        check_field(self.noise, NOISE)
        if self.samples is not None:
            Samples(self.samples)
        if self.spread is not None:
            check_kind(self.spread, "spread", Executor, "an executor of concurrent.futures or None")

    def stepper(self, work: str) -> Progress:
        return stepper(work, self.progress, self.cancel)


def _hash_of(*arrays: np.ndarray | None) -> str:
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(b"-" if array is None else np.ascontiguousarray(array).data)
    return digest.hexdigest()


def _rows(values, name: str) -> np.ndarray:
    array = finite_array(values, name)
    if array.ndim != 2 or array.shape[1] != 3 or not len(array):
        raise ArgumentError(f"{name} has the shape {array.shape}: must be (n, 3)")
    return np.ascontiguousarray(array)


def _directions(given, points: int) -> np.ndarray:
    views = finite_array(given, "directions")
    views = _unit_rows(np.broadcast_to(views, (points, 3)) if views.shape == (3,) else views, "directions")
    if len(views) != points:
        raise ArgumentError(f"directions has {len(views)} rows: must have {points} like points, or be one direction")
    return views


def _unit_rows(values, name: str) -> np.ndarray:
    if values is None:
        raise ArgumentError(f"{name} are missing: must be given with points")
    array = _rows(values, name)
    length = np.linalg.norm(array, axis=1)
    if not (length > 0.0).all():
        raise ArgumentError(f"{name}[{int(np.argmin(length))}] = (0, 0, 0): must have a length")
    return np.ascontiguousarray(array / length[:, None])
