# SPDX-License-Identifier: GPL-3.0-or-later
"""Random walks of light inside a mesh, from points of its surface."""

from __future__ import annotations

import copy
import functools
import hashlib
import math
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..common.arguments import check_choice, check_field, check_seed, check_threads, check_whole, finite_array
from ..common.errors import ArgumentError, InteriorError, quoted
from ..common.progress import Progress, portion, silent, stepper
from ..kinds.boundaries import ALPHA, DISTRIBUTION, IOR
from ..settling import embree
from ..settling.mesh import Mesh, checked_mesh, vertex_points
from .grid import Interior
from .lamps import KINDS, AnyLamp, Surroundings
from .solid import Solid, closed

MOST_SAMPLES = 1 << 32
CHUNK_WALKS = 1 << 12  # samples, of three walks each, between two calls of `cancel`
OPEN, INWARD = 0, 2  # exposures of a point in the core; 1: inside another part of the mesh; 3: on an opaque face
OFF_SURFACE = 1e-4  # relative to the mesh's size: points farther off the surface are refused


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
class Lit:
    """The sources of light: lamps, and the surroundings; None: radiance 1 from all directions."""

    lamps: tuple[AnyLamp, ...] = ()
    surroundings: Surroundings | None = None


class Walker:
    """A checked solid with its interior, and the start points of walks."""

    def __init__(self, solid: Solid, interior: Interior, surface: Surface, points, normals, directions, samples, seed,
                 threads, step: Progress):
        self.interior, self.surface = _checked(interior, Interior, "interior"), surface
        self.samples = check_whole(samples, "samples", 1, MOST_SAMPLES, "must be a whole number from 1 to 2^32")
        self.first = 0  # number of the first sample
        self.seed = check_seed(seed)
        check_threads(threads)
        layer = self._layer = embree.layer()
        step(0.0, "checking the mesh")
        mesh, opaque = closed(solid)
        if points is None:
            if normals is not None:
                raise ArgumentError("normals are given without points: must be given together")
            found = vertex_points(checked_mesh(Mesh(solid.vertices, solid.triangles), "solid"))
            points, normals = found.positions, found.normals
        self.positions, self.normals = _rows(points, "points"), _unit_rows(normals, "normals")
        if len(self.normals) != len(self.positions):
            raise ArgumentError(f"normals has {len(self.normals)} rows: must have {len(self.positions)} like points")
        self.views = None if directions is None else self._views(directions)
        digest = hashlib.sha256(np.ascontiguousarray(mesh.vertices).data)
        digest.update(np.ascontiguousarray(mesh.triangles).data)
        if opaque.any():
            digest.update(opaque.data)
        self.solid_hash = digest.hexdigest()
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        self._centre = 0.5 * (low + high)
        self._size = float(np.linalg.norm(high - low))


        def built(which: tuple[bool, ...], told: Progress):
            return layer.Solid(np.ascontiguousarray(mesh.vertices - self._centre, np.float32), mesh.triangles, threads,
                               lambda fraction: told(fraction, "sorting the faces"), which)

        self._solid = solid_in_core = built(tuple(opaque.tolist()) if opaque.any() else (), step)
        self._clear = functools.cache(lambda: built((), silent) if opaque.any() else solid_in_core)
        self._grid = self._gridded(self.interior)
        self._boundary = layer.Boundary(self.surface.ior, self.surface.alpha, self.surface.distribution)

    def is_open(self) -> np.ndarray:
        """Whether light can enter at each point, (n,): not inside another part of the mesh, not on an opaque face, and
        not where the normal points inwards."""
        return self._exposures(slice(None)) == OPEN

    def _exposures(self, part: slice) -> np.ndarray:
        return self._solid.exposures(self.positions[part] - self._centre, self.normals[part])

    def with_points(self, chosen: np.ndarray, samples: int, seed: int) -> Walker:
        """The same walker for the `chosen` of its points, with other samples and another seed."""
        other = copy.copy(self)
        other.positions, other.normals = self.positions[chosen], self.normals[chosen]
        other.views = None if self.views is None else self.views[chosen]
        other.samples, other.seed = samples, seed
        return other

    def with_samples(self, first: int, samples: int) -> Walker:
        """The same walker for samples [first, first + samples)."""
        other = copy.copy(self)
        other.first, other.samples = first, samples
        return other

    def with_matched(self, interior: Interior) -> Walker:
        """The same walker in another interior, without a boundary or opaque faces and with light from all directions,
        as Cycles' random walk sees the mesh."""
        other = copy.copy(self)
        other.interior, other.surface, other.views = interior, Surface(), None
        other._grid, other._boundary = self._gridded(interior), self._layer.Boundary(1.0, 0.0, "ggx")
        other._solid = self._clear()
        return other

    @property
    def solid_size(self) -> float:
        """Diagonal of the mesh's box, mm."""
        return self._size

    def _gridded(self, interior: Interior):
        return _grid(self._layer, interior, self._centre)

    def exits(self, first: int, last: int, step: Progress, late_after=(math.inf,) * 3) -> list[np.ndarray]:
        """Tally exits: [moments, products, counts, late] of points [first, last). `late`: sums of (w, w r), (points, 3,
        2), over paths with more scatterings than `late_after`, by channel."""
        return self._each(self._layer.walk_to_exits, first, last, step, late_after)

    def lights(self, lit: Lit, first: int, last: int, step: Progress) -> list[np.ndarray]:
        """Tally light of lamps and surroundings: [sums, squares, counts] of points [first, last)."""
        lamps = [lamp.in_core(self._layer, self._centre) for lamp in lit.lamps]
        around = () if lit.surroundings is None else (lit.surroundings.radiance,)
        return self._each(self._layer.walk_to_lights, first, last, step, lamps, self._layer.Surroundings(*around))

    def _each(self, call, first: int, last: int, step: Progress, *more) -> list[np.ndarray]:
        self._require_on_surface(first, last)
        self._require_outward(first, last)
        size = max(1, CHUNK_WALKS // self.samples)
        found = []
        for start in range(first, max(last, first + 1), size):
            part = slice(start, min(start + size, last))
            views = None if self.views is None else self.views[part]
            positions = np.ascontiguousarray(self.positions[part] - self._centre)
            sums: list[np.ndarray] = []
            for walk in range(0, self.samples, CHUNK_WALKS):
                walks = min(CHUNK_WALKS, self.samples - walk)
                done = (start - first) * self.samples + walk
                step(done / max(1, (last - first) * self.samples), f"{done:,} walks")
                more_sums = call(self._solid, self._grid, self._boundary, positions, self.normals[part], views, start,
                                 self.first + walk, walks, self.seed, *more)
                sums = [old + new for old, new in zip(sums, more_sums, strict=True)] if sums else list(more_sums)
            found.append(sums)
        return [np.concatenate(arrays) for arrays in zip(*found, strict=True)]

    def _require_on_surface(self, first: int, last: int) -> None:
        """Raises InteriorError if a point is off the surface."""
        places = np.ascontiguousarray(self.positions[first:last] - self._centre, np.float32)
        if not (np.abs(places) <= 2.0 * self._size).all():
            distance = np.where((np.abs(places) <= 2.0 * self._size).all(axis=1), 0.0, math.inf)
        else:
            distance = self._solid.distances(places, 2.0 * OFF_SURFACE * self._size)
        if distance.max(initial=0.0) > OFF_SURFACE * self._size:
            worst = first + int(np.argmax(distance))
            where = "({:g}, {:g}, {:g})".format(*self.positions[worst])
            raise InteriorError(f"points[{worst}] = {where} lies off the surface: must lie within "
                                f"{OFF_SURFACE * self._size:g} mm of a face")

    def _require_outward(self, first: int, last: int) -> None:
        """Raises InteriorError if a normal points inwards."""
        inward = np.flatnonzero(self._exposures(slice(first, last)) == INWARD)
        if len(inward):
            worst = first + int(inward[0])
            where = "({:g}, {:g}, {:g})".format(*self.normals[worst])
            raise InteriorError(f"normals[{worst}] = {where} points into the solid: must point outwards")

    def _views(self, directions) -> np.ndarray:
        views = finite_array(directions, "directions")
        if views.shape == (3,):
            views = np.broadcast_to(views, self.positions.shape)
        views = _unit_rows(views, "directions")
        if len(views) != len(self.positions):
            raise ArgumentError(f"directions has {len(views)} rows: must have {len(self.positions)} like points, or be "
                                "one direction")
        return views


def start(solid, interior, surface, points, normals, directions, samples, seed, threads, progress, cancel, lamps):
    """(a Walker, the result of `lamps()`, a step function for the walks, a function that returns the elapsed seconds).
    Raises the errors of walk_in_mesh."""
    began = time.perf_counter()
    step = stepper("the walk in the mesh", progress, cancel)
    surface = _checked(surface, Surface, "surface")
    found = lamps()
    walker = Walker(solid, interior, surface, points, normals, directions, samples, seed, threads,
                    portion(step, 0.0, 0.1))
    return walker, found, portion(step, 0.1, 1.0), lambda: time.perf_counter() - began


def checked_lit(lamps, surroundings, surface: Surface) -> Lit:
    """Check lamps and surroundings. Raises ArgumentError."""
    kinds = tuple(KINDS.values())
    if not isinstance(lamps, Sequence) or not all(isinstance(one, kinds) for one in lamps):
        names = ", ".join(f"lamina.{kind.__name__}" for kind in kinds)
        raise ArgumentError(f"lamps = {quoted(lamps)}: must be a list of {names}")
    for number, lamp in enumerate(lamps):
        if surface.is_smooth and lamp.too_small:
            raise ArgumentError(f"lamps[{number}].{lamp.too_small} behind a smooth boundary, or alpha above 0")
    return Lit(tuple(lamps), None if surroundings is None else _checked(surroundings, Surroundings, "surroundings"))


def _checked(value, kind: type, name: str):
    if isinstance(value, kind):
        return value
    raise ArgumentError(f"{name} = {quoted(value)}: must be a lamina.{kind.__name__}")


def _grid(layer, interior: Interior, centre: np.ndarray):
    low, high = (tuple(np.array(corner) - centre) for corner in (interior.low, interior.high))
    voxels = np.ascontiguousarray(interior.voxels)
    if interior.palette:
        palette = [(one.sigma_s, one.sigma_a, one.g) for one in interior.palette]
        return layer.Grid.of_mixture(voxels, low, high, interior.smooth, palette)
    return layer.Grid.of_coefficients(voxels.view(np.uint16), low, high, interior.smooth, interior.g)


def _rows(values, name: str) -> np.ndarray:
    array = finite_array(values, name)
    if array.ndim != 2 or array.shape[1] != 3 or not len(array):
        raise ArgumentError(f"{name} has the shape {array.shape}: must be (n, 3)")
    return np.ascontiguousarray(array)


def _unit_rows(values, name: str) -> np.ndarray:
    if values is None:
        raise ArgumentError(f"{name} are missing: must be given with points")
    array = _rows(values, name)
    length = np.linalg.norm(array, axis=1)
    if not (length > 0.0).all():
        raise ArgumentError(f"{name}[{int(np.argmin(length))}] = (0, 0, 0): must have a length")
    return np.ascontiguousarray(array / length[:, None])
