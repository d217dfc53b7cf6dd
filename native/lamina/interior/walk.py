# SPDX-License-Identifier: GPL-3.0-or-later
"""Random walks of light inside a mesh, from points of its surface."""

from __future__ import annotations

import copy
import functools
import hashlib
import math
from collections.abc import Sequence
from dataclasses import replace
from typing import cast

import numpy as np

from ..common.errors import InteriorError
from ..common.progress import Progress, silent
from ..settling import embree
from .grid import Interior
from .lamps import AnyLamp
from .problem import Problem, Samples, TexelImage
from .solid import closed

CHUNK_WALKS = 1 << 12  # samples, of three walks each, between two calls of `cancel`
CHUNK_PHOTONS = 1 << 14  # the same of photons
PHOTONS, LAMP = 1 << 63, 1 << 48  # in the numbers of samples, so that no others have the same random numbers
OPEN, BURIED, INWARD = 0, 1, 2  # exposures of a point in the core; 3: on an opaque face
OFF_SURFACE = 1e-4  # relative to the mesh's size: points farther off the surface are refused


class Walker:
    """A problem that is ready for walks. `problem` has its points; `solid_size`: diagonal of the mesh's box, mm.
    `notes`: sentences about repairs of the mesh; `threads`: 0 for all hardware threads."""

    def __init__(self, problem: Problem, threads: int, step: Progress):
        layer, self.threads = embree.layer(), threads
        self._layer = layer
        step(0.0, "checking the mesh")
        found = closed(problem.solid)
        mesh, opaque, self._given, self.notes = found.mesh, found.opaque, found.given, found.notes()
        self.problem = replace(problem, points=problem.points.on(problem.solid))
        digest = hashlib.sha256(np.ascontiguousarray(mesh.vertices).data)
        digest.update(np.ascontiguousarray(mesh.triangles).data)
        if opaque.any():
            digest.update(opaque.data)
        self._solid_hash = digest.hexdigest()
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        centre = self._centre = 0.5 * (low + high)
        self.solid_size = float(np.linalg.norm(high - low))

        def built(which: tuple[bool, ...], told: Progress):
            return layer.Solid(np.ascontiguousarray(mesh.vertices - centre, np.float32), mesh.triangles, threads,
                               lambda fraction: told(fraction, "sorting the faces"), which)

        others = None if problem.lights is None else problem.lights.occluders
        is_clear = others is None and not opaque.any()
        self._solid = solid_in_core = built(tuple(opaque.tolist()) if opaque.any() else (), step)
        if others is not None:
            solid_in_core.stand_among(np.ascontiguousarray(others.vertices - centre, np.float32), others.triangles,
                                      others.albedo, others.emission, lambda _fraction: step(1.0, "sorting the faces"),
                                      others.links)
        self._clear = functools.cache(lambda: solid_in_core if is_clear else built((), silent))
        self._grid = _grid(layer, self.problem.interior, centre)

    def is_open(self) -> np.ndarray:
        """Whether light can enter at each point, (n,): not inside another part of the mesh, not on an opaque face, and
        not where the normal points inwards."""
        return self._exposures(slice(None)) == OPEN

    def only(self, chosen: np.ndarray) -> Walker:
        """A walker for the `chosen` of the points: indices or booleans."""
        return self._with(points=self.problem.points.only(chosen))

    def lit_by_photons(self, image: TexelImage) -> Walker:
        """A walker of the same problem with an image, whose lamps shine by photons."""
        return self._with(image=image)

    def encloses(self, lamps: Sequence[AnyLamp]) -> bool:
        """Whether one of the lamps lies inside the solid."""
        places = np.array([place for lamp in lamps for place in lamp.places]).reshape(-1, 3)
        ups = np.tile([0.0, 0.0, 1.0], (len(places), 1))
        return bool((self._solid.exposures(places - self._centre, ups) == BURIED).any())

    def matched(self, interior: Interior) -> Walker:
        """A walker in another interior, without a boundary, opaque faces or occluders and with light from all
        directions, as Cycles' random walk sees the mesh."""
        other = self._with(interior=interior, surface=None, points=replace(self.problem.points, views=None))
        other._grid, other._solid = _grid(self._layer, interior, self._centre), self._clear()
        return other

    def described(self, samples: Samples) -> dict:
        """The description of a run, the same for all its parts."""
        problem = self.problem.described_photons if samples.lamps else self.problem.described
        return {"solid": self._solid_hash, **problem, "first": samples.first, "samples": samples.count,
                "seed": samples.seed}

    def exits(self, samples: Samples, step: Progress, part: range | None = None,
              late_after=(math.inf,) * 3) -> list[np.ndarray]:
        """Tally exits: [moments, products, counts, late] of all points, or of a `part`. `late`: sums of (w, w r),
        (points, 3, 2), over paths with more scatterings than `late_after`, by channel."""
        return self._each(self._layer.walk_to_exits, samples, step, part, late_after)

    def lights(self, samples: Samples, step: Progress, part: range | None = None) -> list[np.ndarray]:
        """Tally light of lamps and surroundings: [sums, squares, counts] of all points, or of a `part`."""
        lit = self.problem.lit_by_walks
        lamps = [self._lamp_in_core(lamp) for lamp in lit.lamps]
        around = () if lit.surroundings is None else (lit.surroundings.radiance,)
        return self._each(self._layer.walk_to_lights, samples, step, part, lamps, lit.by_occluders,
                          self._layer.Surroundings(*around))

    def photons(self, samples: Samples, step: Progress, part: range | None = None) -> list[np.ndarray]:
        """Tally photons: [sums, squares, counts by lamp] at all points. `part`: of the photons of each lamp, of which
        there are as many as samples of all points."""
        texels, sources = self._image_in_core
        part = range(samples.count * len(self.problem.points.positions)) if part is None else part
        first, sums = samples.first * len(self.problem.points.positions), []
        for lamp, source in enumerate(sources):
            found: list[np.ndarray] = []
            for start in range(part.start, part.stop, CHUNK_PHOTONS):
                done = lamp * len(part) + start - part.start
                step(done / (len(sources) * len(part)), f"{done:,} photons")
                count = min(CHUNK_PHOTONS, part.stop - start)
                more = self._layer.photons_to_texels(self._solid, self._grid, self._boundary, source, texels,
                                                     PHOTONS + lamp * LAMP + first + start, count, samples.seed)
                found = [old + new for old, new in zip(found, more, strict=True)] if found else list(more)
            sums.append(found)
        values, squares, counts = zip(*sums, strict=True)
        return [np.stack(values, axis=1), np.stack(squares, axis=1), np.concatenate(counts)]

    @functools.cached_property
    def texel_areas(self) -> np.ndarray:
        """The area in mm^2 of the surface that each point of the image stands for, (n,)."""
        return np.array(self._image_in_core[0].areas)

    @functools.cached_property
    def _image_in_core(self) -> tuple:
        """The image, and where each lamp's light meets the solid."""
        image, points = cast(TexelImage, self.problem.image), self.problem.points
        uvs = np.where(self._given[:, None, None] >= 0, image.uvs[self._given], 0.0)
        numbers = np.where(image.mask, np.cumsum(image.mask).reshape(image.mask.shape) - 1, -1)
        texels = self._layer.SurfaceTexels(self._solid, np.ascontiguousarray(uvs, float),
                                           numbers.astype(np.int32), points.positions - self._centre, points.normals)
        return texels, [self._layer.PhotonSource(self._solid, self._lamp_in_core(lamp), self._grid, self._boundary)
                        for lamp in self.problem.lights.lamps]  # type: ignore[union-attr]  # an image has lamps

    def _lamp_in_core(self, lamp: AnyLamp):
        return lamp.in_core(self._layer, self._centre).linked(lamp.linking)

    @functools.cached_property
    def _boundary(self):
        surface = self.problem.boundary
        return self._layer.Boundary(surface.ior, surface.alpha, surface.distribution)

    def _with(self, **changes) -> Walker:
        other = copy.copy(self)
        for name in ("_boundary", "_image_in_core", "texel_areas"):  # depend on the problem
            other.__dict__.pop(name, None)
        other.problem = replace(self.problem, **changes)
        return other

    def _exposures(self, part: slice) -> np.ndarray:
        points = self.problem.points.only(part)
        return self._solid.exposures(points.positions - self._centre, points.normals)

    def _each(self, call, samples: Samples, step: Progress, part: range | None, *more) -> list[np.ndarray]:
        points = self.problem.points
        part = range(len(points.positions)) if part is None else part
        self._require_on_surface(part)
        self._require_outward(part)
        size = max(1, CHUNK_WALKS // samples.count)
        found = []
        for start in range(part.start, max(part.stop, part.start + 1), size):
            here = points.only(slice(start, min(start + size, part.stop)))
            positions = np.ascontiguousarray(here.positions - self._centre)
            sums: list[np.ndarray] = []
            for walk in range(0, samples.count, CHUNK_WALKS):
                walks = min(CHUNK_WALKS, samples.count - walk)
                done = (start - part.start) * samples.count + walk
                step(done / max(1, len(part) * samples.count), f"{done:,} walks")
                more_sums = call(self._solid, self._grid, self._boundary, positions, here.normals, here.views, start,
                                 samples.first + walk, walks, samples.seed, *more)
                sums = [old + new for old, new in zip(sums, more_sums, strict=True)] if sums else list(more_sums)
            found.append(sums)
        return [np.concatenate(arrays) for arrays in zip(*found, strict=True)]

    def _require_on_surface(self, part: range) -> None:
        """Raises InteriorError if a point is off the surface."""
        positions = self.problem.points.positions[part.start:part.stop]
        places = np.ascontiguousarray(positions - self._centre, np.float32)
        if not (np.abs(places) <= 2.0 * self.solid_size).all():
            distance = np.where((np.abs(places) <= 2.0 * self.solid_size).all(axis=1), 0.0, math.inf)
        else:
            distance = self._solid.distances(places, 2.0 * OFF_SURFACE * self.solid_size)
        if distance.max(initial=0.0) > OFF_SURFACE * self.solid_size:
            worst = int(np.argmax(distance))
            where = "({:g}, {:g}, {:g})".format(*positions[worst])
            raise InteriorError(f"points[{part.start + worst}] = {where} lies off the surface: must lie within "
                                f"{OFF_SURFACE * self.solid_size:g} mm of a face")

    def _require_outward(self, part: range) -> None:
        """Raises InteriorError if a normal points inwards."""
        inward = np.flatnonzero(self._exposures(slice(part.start, part.stop)) == INWARD)
        if len(inward):
            worst = part.start + int(inward[0])
            where = "({:g}, {:g}, {:g})".format(*self.problem.points.normals[worst])
            raise InteriorError(f"normals[{worst}] = {where} points into the solid: must point outwards")


def _grid(layer, interior: Interior, centre: np.ndarray):
    low, high = (tuple(np.array(corner) - centre) for corner in (interior.low, interior.high))
    voxels = np.ascontiguousarray(interior.voxels)
    if interior.palette:
        palette = [(one.sigma_s, one.sigma_a, one.g) for one in interior.palette]
        return layer.Grid.of_mixture(voxels, low, high, interior.smooth, palette)
    return layer.Grid.of_coefficients(voxels.view(np.uint16), low, high, interior.smooth, interior.g)
