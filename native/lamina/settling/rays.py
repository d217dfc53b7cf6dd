# SPDX-License-Identifier: GPL-3.0-or-later
"""The rays of a settling. Nothing else of a settling needs the scene, so that rays can run elsewhere, in parts.

A ray depends on its point, and on the point's number, which gives the random numbers. The dust of a point is therefore
the same for any division of the points into parts."""

from __future__ import annotations

import time as clock
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..common.progress import Progress
from ..kinds.dust import Settling
from . import balance, embree
from .balance import FallFrame, Window
from .mesh import Frame, Mesh

CHUNK_RAYS = 1 << 21  # between two calls of `cancel`
# Distance of ray origins from the surface, relative to its size: 100 times the rounding of single precision, and less
# than 1 % of an edge in a mesh of a million faces.
OFFSET = 2.0**-17
# Streams of random numbers.
_SHELTER_STREAM, _EDGE_STREAM = 0x7368_656C_7465_7200, 0x6564_6765_0000_0000


@dataclass(frozen=True, eq=False)
class Place:
    """What rays are traced in: a checked surface among checked occluders, the surface's frame, and how dust falls."""

    surface: Mesh
    occluders: list[Mesh]
    frame: Frame
    fall: FallFrame
    settings: Settling
    seed: int


@dataclass(frozen=True, eq=False)
class Starts:
    """Points that rays start from, in the frame of the surface. positions, normals: (n, 3) float32, normals of length 1
    or 0; slides: (n,) int8, 0 where no dust slides off, otherwise 1, or -1 where it lies on the side opposite to the
    normal."""

    positions: np.ndarray
    normals: np.ndarray
    slides: np.ndarray

    def __len__(self) -> int:
        return len(self.positions)

    def part(self, first: int, last: int) -> Starts:
        return Starts(self.positions[first:last], self.normals[first:last], self.slides[first:last])

    @staticmethod
    def joined(parts: Sequence[Starts]) -> Starts:
        return Starts(*(np.concatenate([getattr(part, name) for part in parts])
                        for name in ("positions", "normals", "slides")))


@dataclass(frozen=True, eq=False)
class Traced:
    """What the rays of n points found. shares: (n,) float32, the dust that arrives, relative to an open horizontal
    plane; two-sided (n, 2), on the front and on the back. exposures: (n,) float32, the share of open directions around
    a point that dust slides off, 1 at others. convexities: (n,) float32, how close to a convex edge a dusty point is, 0
    where no dust is rubbed off. rays: their number; seconds: the time they took."""

    shares: np.ndarray
    exposures: np.ndarray
    convexities: np.ndarray
    rays: int
    seconds: float

    def part(self, first: int, last: int) -> Traced:
        """Without numbers of rays and seconds."""
        return Traced(self.shares[first:last], self.exposures[first:last], self.convexities[first:last], 0, 0.0)

    @staticmethod
    def joined(parts: Sequence[Traced]) -> Traced:
        """`parts` in the sequence of their points."""
        shares, exposures, convexities = (np.concatenate([getattr(part, name) for part in parts])
                                          for name in ("shares", "exposures", "convexities"))
        return Traced(shares, exposures, convexities, sum(part.rays for part in parts),
                      sum(part.seconds for part in parts))


def reach_of(settings: Settling, scale: float) -> float:
    """Distance in metres up to which neighbors shelter dust that slides; `scale`: of the surface's frame."""
    return 0.1 * scale if settings.reach is None else settings.reach


def _edge_of(settings: Settling, scale: float) -> float:
    """Distance in metres from an edge up to which dust is rubbed off."""
    return 0.04 * scale if settings.edge is None else settings.edge


class Rays:
    """Rays through one place. Raises DustUnavailable."""

    def __init__(self, place: Place, threads: int, step: Progress):
        layer = embree.layer()
        meshes = [(place.frame.floats(mesh.vertices), mesh.triangles) for mesh in (place.surface, *place.occluders)]
        self._scene = layer.Scene(meshes, threads, lambda fraction: step(fraction, "sorting the faces"))
        settings, seed = place.settings, place.seed
        self._place, self._core = place, place.fall.core(layer)
        self._around = max(16, settings.rays // 2)  # rays of an exposure
        self._options = layer.Options(settings.rays, seed, settings.two_sided, OFFSET)
        self._sheltered = layer.Options(self._around, seed ^ _SHELTER_STREAM, False, OFFSET)
        self._edges = layer.Options(self._around, seed ^ _EDGE_STREAM, settings.two_sided, OFFSET)

    def grains(self, window: Window) -> balance.Forward:
        """Grains traced from above."""
        return balance.trace(self._scene, self._core, window, len(self._place.occluders), self._place.seed)

    def traced(self, starts: Starts, first: int, step: Progress, before: int = 0) -> Traced:
        """The rays of at least one point. The points' numbers start at `first`; the text of `step` counts rays from
        `before`."""
        started = clock.perf_counter()
        found, rays = [], before
        size = max(1, CHUNK_RAYS // (self._place.settings.rays + self._around))
        for low in range(0, len(starts), size):
            step(low / len(starts), f"{rays:,} rays")
            found.append(self._chunk(starts.part(low, low + size), first + low))
            rays += found[-1].rays
        whole = Traced.joined(found)
        return replace(whole, seconds=clock.perf_counter() - started)

    def _chunk(self, starts: Starts, first: int) -> Traced:
        settings = self._place.settings
        shares, rays = self._scene.arrivals(self._core, starts.positions, starts.normals, first, self._options)
        arrives = shares.max(axis=1, initial=0.0) > 0.0 if settings.two_sided else shares > 0.0
        exposures, sheltering = self._exposures(starts, starts.slides * arrives, first)
        sides = np.where(shares[:, 1] > shares[:, 0], -1, 1) if settings.two_sided else 1
        convexities, rubbing = self._convexities(starts, sides * arrives, first)
        return Traced(shares, exposures, convexities, rays + sheltering + rubbing, 0.0)

    def _exposures(self, starts: Starts, sides: np.ndarray, first: int) -> tuple[np.ndarray, int]:
        """(n,) exposures on the sides (n,), 1 or -1, at which dust slides; 1 at others, 0. And the number of rays."""
        settings, scale = self._place.settings, self._place.frame.scale
        if settings.concavity == 0.0 or not sides.any():
            return np.ones(len(starts), np.float32), 0
        # A point without a normal costs no rays, and has the exposure 1.
        normals = starts.normals * sides[:, None].astype(np.float32)
        reach = reach_of(settings, scale) / scale
        return self._scene.exposures(starts.positions, normals, first, self._sheltered, reach)

    def _convexities(self, starts: Starts, sides: np.ndarray, first: int) -> tuple[np.ndarray, int]:
        """(n,) convexities on the sides (n,), 1 or -1, that are dusty; 0 at others. And the number of rays."""
        settings, scale = self._place.settings, self._place.frame.scale
        if settings.rubbed == 0.0 or not sides.any():
            return np.zeros(len(starts), np.float32), 0
        normals = starts.normals * sides[:, None].astype(np.float32)
        return self._scene.convexities(starts.positions, normals, first, self._edges, _edge_of(settings, scale) / scale)
