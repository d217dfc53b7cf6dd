# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust that settles: the optical thickness of dust that falls from above and stays, at each point of a surface.

Grains fall with directions spread over a cone, and wind is added to their velocity. The amount is the dust that falls
through an open horizontal plane. A surface with normal n receives the share n.d of grains that come from the direction
d = up + t (t horizontal), if nothing is in their way. Grains slide off beyond the angle of repose, and stay in
concavities. The factors are those of Hsu and Wong, "Simulating Dust Accumulation" (1995): exposure to the source,
inclination, stickiness; here with the flux of the grains in place of tuned functions, so that mass is conserved."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np

from ..common.arguments import check_kind, check_seed, check_threads, check_whole
from ..common.progress import Progress, portion, stepper
from ..kinds.dust import Settling
from ..kinds.limits import MOST_TEXELS
from ..kinds.substances import extinction_of
from . import embree
from .corners import corners_of, moved_off_edges
from .mesh import Corners, Mesh, Points, check_points, checked_mesh, checked_meshes, vertex_points
from .rays import OFFSET, Rays
from .sky import Laid, Sky
from .statistics import Statistics, Sums
from .texels import TexelMap, spread

BLOCK = 1 << 18  # points at a time, to limit memory
INSET = 16.0 * OFFSET  # distance by which points at sharp edges are moved into a face, relative to the surface's size


@dataclass(frozen=True, eq=False)
class Dust:
    """tau: (n,) float32, optical thickness along the normal of the dust that stays at each point, or (height, width) of
    an image; arrived: that of the dust that fell there, likewise. `settings`, `seed`: the arguments of settle.

    back: the part of tau on the side opposite to the normal, likewise; None unless two-sided.
    vertices: (n,), the vertex of each value: first each vertex in sequence, then the further normals of vertices at
        sharp edges. None for given points and images.
    corners: (m, 3), the index of the value of each corner of each triangle: `tau[corners]`. None likewise."""

    tau: np.ndarray
    arrived: np.ndarray
    statistics: Statistics
    settings: Settling = field(default_factory=Settling)
    seed: int = 0
    back: np.ndarray | None = None
    vertices: np.ndarray | None = None
    corners: np.ndarray | None = None

    @property
    def grams(self) -> np.ndarray:
        """float32, in the shape of tau: areal mass in g/m^2."""
        return (self.tau / extinction_of(self.settings.extinction)).astype(np.float32)


def available() -> str:
    """Empty if dust can settle, otherwise one sentence with the reason (no working Embree layer)."""
    return embree.why_not()


def settle(surface: Mesh, points: Points | tuple | None = None, occluders: Iterable[Mesh] = (),
           settings: Settling | None = None, seed: int = 0, progress: Progress | None = None,
           cancel: Callable[[], bool] | None = None, threads: int = 0) -> Dust:
    """Dust on a surface among occluders, all in world space and metres.

    `points`: where dust is wanted. None: the surface's vertices in sequence, and after them further values for vertices
    with several normals (see Mesh.sharp_angle, Dust.corners). Otherwise Points, or (positions, normals), each (n, 3),
    for example from `texel_points`. Vertices without faces get no dust. The same seed gives the same bytes for any
    number of `threads` (0: all). `progress(fraction, text)` is called with the completed share. `cancel()` is called
    often; Cancelled is raised if it returns true. Raises DustError, ValueError, and DustUnavailable without a working
    Embree layer."""
    run = _Run(surface, occluders, settings, seed, progress, cancel, threads)
    corners = None
    if points is None:
        corners, points = vertices_of(run.sky, portion(run.step, 0.2, 0.25))
    else:
        points = check_points(points)
    laid = run.laid(blocks_of(points), max(len(points.positions), 1))
    return collected(len(points.positions), corners, laid, run.statistics, run.settings, seed)


def settle_image(surface: Mesh, uvs_per_corner: np.ndarray, size: int | tuple[int, int], occluders: Iterable[Mesh] = (),
                 settings: Settling | None = None, seed: int = 0, progress: Progress | None = None,
                 cancel: Callable[[], bool] | None = None, *, threads: int = 0, margin: int = 4) -> Dust:
    """Dust on a surface as an image over a UV map: `texel_points`, `settle` and `dilate` in one, a band of rows at a
    time, so a large image needs little extra memory. tau, arrived and back are (height, width), rows from the bottom.
    tau and back are extended over `margin` texels around the islands, arrived is not.

    Raises the errors of these functions, and DustError if no texel lies on the surface. The notes of the statistics
    mention parts of the surface that the UV map leaves out."""
    check_whole(margin, "margin", 0, MOST_TEXELS)
    run = _Run(surface, occluders, settings, seed, progress, cancel, threads)
    texels = TexelMap(run.surface, uvs_per_corner, size)
    images = [np.zeros((texels.height, texels.width), np.float32) for _ in range(3 if run.settings.two_sided else 2)]
    mask = np.zeros((texels.height, texels.width), bool)

    def bands():
        number = 0
        for rows, points, inside in texels.bands():
            mask[rows] = inside
            if len(points.positions):
                yield number, rows, points
            number += len(points.positions)

    for rows, laid in run.laid(bands(), texels.height, lambda rows: rows.stop):
        values = laid.tau, laid.arrived, None if laid.back_share is None else laid.tau * laid.back_share
        for image, value in zip(images, values, strict=False):
            image[rows][mask[rows]] = value
    texels.require_texels(bool(mask.any()))
    tau, arrived = spread(images[0], mask, margin), images[1]
    back = spread(images[2], mask, margin) if run.settings.two_sided else None
    return Dust(tau, arrived, run.statistics(texels.notes()), run.settings, seed, back)


def settings_of(given: Settling | None) -> Settling:
    """The settings, by default the usual ones. Raises ArgumentError."""
    return Settling() if given is None else check_kind(given, "settings", Settling, "a lamina.dust.Settling or None")


def vertices_of(sky: Sky, step: Progress) -> tuple[Corners, Points]:
    """The points of the surface's vertices, as settle takes them without given points."""
    surface = sky.place.surface
    corners = corners_of(surface)
    points = vertex_points(surface, step, corners)
    return corners, moved_off_edges(surface, points, corners, INSET * sky.frame.scale)


def blocks_of(points: Points) -> Iterator[tuple[int, slice, Points]]:
    """(first number, indices, points) of each block."""
    for first in range(0, len(points.positions), BLOCK):
        part = slice(first, min(first + BLOCK, len(points.positions)))
        areas = None if points.areas is None else points.areas[part]
        yield first, part, Points(points.positions[part], points.normals[part], areas)


def collected(count: int, corners: Corners | None, laid: Iterable[tuple[slice, Laid]],
              statistics: Callable[[], Statistics], settings: Settling, seed: int) -> Dust:
    """The dust of `count` points from that of their blocks; `statistics` is called after the last block."""
    tau, arrived = np.empty(count, np.float32), np.empty(count, np.float32)
    back = np.empty(count, np.float32) if settings.two_sided else None
    for part, block in laid:
        tau[part], arrived[part] = block.tau, block.arrived
        if back is not None:
            back[part] = block.tau * block.back_share
    return Dust(tau, arrived, statistics(), settings, seed, back,
                None if corners is None else corners.vertex, None if corners is None else corners.point)


class _Run:
    """One settling, from its meshes to its statistics."""

    def __init__(self, surface, occluders, settings, seed, progress, cancel, threads):
        self._started = clock.perf_counter()
        self.settings = settings_of(settings)
        check_seed(seed)
        check_threads(threads)
        embree.layer()
        self.step = stepper("the settling of dust", progress, cancel)
        self.step(0.0, "reading the meshes")
        self.surface = checked_mesh(surface, "surface")
        others = checked_meshes(occluders, "occluders")
        self.sky = Sky(self.surface, others, self.settings, seed)
        self._rays = Rays(self.sky.place, threads, portion(self.step, 0.05, 0.2))
        self._traced = 0
        self._sums = Sums(self.settings)

    def laid(self, blocks: Iterator, total: int, done=lambda place: place.stop) -> Iterator[tuple[slice, Laid]]:
        """(indices, dust) of each block (first number, indices, points); progress is `done(indices)` of `total`."""
        before = 0
        for number, place, points in blocks:
            part = portion(self.step, 0.25 + 0.7 * before / total, 0.25 + 0.7 * min(done(place), total) / total)
            starts, stays = self.sky.starts(points)
            traced = self._rays.traced(starts, number, part, self._traced)
            self._traced += traced.rays
            laid = self.sky.laid(points, stays, traced)
            self._sums.add(laid.arrived, laid.stays, laid.left, points.areas)
            before = done(place)
            yield place, laid

    def statistics(self, notes: tuple[str, ...] = ()) -> Statistics:
        forward = self._rays.grains(self.sky.window())
        self.step(1.0, f"{self._traced:,} rays")
        seconds = clock.perf_counter() - self._started
        return self._sums.statistics(forward, self.sky.names, self._traced, seconds, notes)
