# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust that settles: the optical thickness of what falls from above and stays, at each point of a surface.

Grains fall with directions spread over a cone, and wind is added to their velocity. What passes through an open
horizontal plane is the amount; a surface with normal n gets, of grains that come from direction d = up + t (t across
gravity), the share n.d where nothing is in their way. They slide off beyond the angle of repose, and hold in
concavities. The factors are those of Hsu and Wong, "Simulating Dust Accumulation" (1995): exposure to the source,
inclination, stickiness; here with the flux of the grains in place of tuned functions, so that mass is conserved."""

from __future__ import annotations

import math
import numbers
import time as clock
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from . import dust_balance, rays
from .arguments import check_seed, check_threads
from .dust_balance import FallFrame
from .dust_materials import extinction_of
from .dust_mesh import (
    Mesh,
    Points,
    check_points,
    checked_mesh,
    common_frame,
    unit_normals,
    used_vertices,
    vertex_points,
)
from .dust_patches import patches
from .dust_texels import dilate, texel_points
from .errors import DustError
from .progress import Progress, portion, stepper

__all__ = ["Dust", "DustError", "Mesh", "Points", "Settling", "Statistics", "available", "dilate", "settle",
           "texel_points"]

CHUNK_RAYS = 1 << 21  # between two looks at `cancel`
# Rays start this far off the surface, relative to its size: a hundred roundings of single precision, and less than a
# hundredth of an edge of a mesh of a million faces.
OFFSET = 2.0**-17
_SHELTER_STREAM = 0x7368_656C_7465_7200  # random numbers of their own


@dataclass(frozen=True)
class Settling:
    """How dust falls and what stays. Angles in radians, lengths in metres. Raises DustError.

    amount: optical thickness on an open horizontal plate, [0, 1000]; 1 if `grams` is not given.
    grams: areal mass in g/m^2 instead of the amount, [0, 1e6]; times `extinction` it is the optical thickness.
    extinction: of mass, in m^2/g, (0, 1000], or the id of a dust in `lamina.dust_materials` (green channel).
    time: how long it falls, in units of the time in which `amount` does, [0, 1e6].
    gravity: the direction down, of any length but 0.
    spread: half-angle of the cone from which grains fall, evenly over solid angle, [0, 1.5].
    wind: velocity of the wind over that of the fall, metres per metre; its part along gravity is left out. Of length
        1 it tilts the fall by 45 degrees. Length at most 20.
    repose: slope at which half of the grains slide off, [0, pi]; pi: all stay wherever they touch.
    repose_width: range of slopes, centred on it, over which that sets in, [0, pi].
    concavity: how much of what would slide holds where nothing is open above, [0, 1]: a share concavity * (1 -
        exposure) stays; exposure is the cosine-weighted part of the hemisphere that is open within `reach`.
    reach: distance up to which neighbours shelter, > 0; None: 5 % of the diagonal of the surface's box.
    coverage: share of the surface, [0, 1], on which dust is left in soft-edged patches; elsewhere it is wiped off.
    patch: size of those patches, > 0; None: 10 % of the diagonal.
    two_sided: dust lies on either side of a face (leaves, cloth, normals not to be trusted), as a sum. Otherwise
        only on the side that the normal points to. Any face stops grains, whichever side they meet.
    rays: rays a point, 1 to 65536."""

    amount: float | None = None
    grams: float | None = None
    extinction: float | str = "dust-saharan-1.7um"
    time: float = 1.0
    gravity: Sequence[float] = (0.0, 0.0, -1.0)
    spread: float = math.radians(35.0)
    wind: Sequence[float] = (0.0, 0.0, 0.0)
    repose: float = math.radians(45.0)
    repose_width: float = math.radians(20.0)
    concavity: float = 0.5
    reach: float | None = None
    coverage: float = 1.0
    patch: float | None = None
    two_sided: bool = False
    rays: int = 256

    def __post_init__(self):
        if self.amount is not None and self.grams is not None:
            raise DustError("settling has both amount and grams: must have one of them")
        for name, low, high in (("amount", 0.0, 1e3), ("grams", 0.0, 1e6), ("time", 0.0, 1e6), ("spread", 0.0, 1.5),
                                ("repose", 0.0, math.pi), ("repose_width", 0.0, math.pi), ("concavity", 0.0, 1.0),
                                ("reach", 1e-12, 1e12), ("coverage", 0.0, 1.0), ("patch", 1e-12, 1e12)):
            value = getattr(self, name)
            if value is None and name in ("amount", "grams", "reach", "patch"):
                continue
            if not _is_number(value) or not low <= value <= high:
                raise DustError(f"settling.{name} = {value!r}: must lie in [{low:g}, {high:g}]")
        if isinstance(self.rays, bool) or not isinstance(self.rays, int) or not 1 <= self.rays <= 65536:
            raise DustError(f"settling.rays = {self.rays!r}: must be a whole number from 1 to 65536")
        extinction_of(self.extinction)
        down = _vector(self.gravity, "settling.gravity")
        if not np.linalg.norm(down) > 0.0:
            raise DustError(f"settling.gravity = {tuple(self.gravity)!r}: must not be zero")
        if np.linalg.norm(_vector(self.wind, "settling.wind")) > 20.0:
            raise DustError(f"settling.wind = {tuple(self.wind)!r}: must be at most 20 long")

    @property
    def tau(self) -> float:
        """Optical thickness on an open horizontal plate."""
        if self.grams is not None:
            return self.grams * extinction_of(self.extinction) * self.time
        return (1.0 if self.amount is None else self.amount) * self.time


@dataclass(frozen=True)
class Statistics:
    """What people want to know. Masses are optical thickness times area in m^2; the first four need areas, and are
    None for points without.

    arrived = deposited + slid + wiped, summed over the points. By other rays, traced from above along `grains`
    grains: launched = fell + behind + stopped + missed, `fell` on faces from the side that takes dust and `behind` on
    their other side, `stopped` by occluders; `fell_stderr` is the standard error of `fell`. arrived and fell are the
    same thing, found twice: they differ by that error and by how coarse the mesh is."""

    points: int
    rays: int
    seconds: float
    mean: float  # optical thickness, over the area where areas are known
    maximum: float
    covered: float  # share of the points (of the area) with more than 1 % of the amount
    arrived: float | None
    deposited: float | None
    slid: float | None
    wiped: float | None
    launched: float
    fell: float
    fell_stderr: float
    behind: float
    stopped: float
    missed: float
    grains: int
    notes: tuple[str, ...] = ()

    @property
    def rays_per_second(self) -> float:
        return self.rays / self.seconds if self.seconds > 0.0 else 0.0

    def __str__(self) -> str:
        return (f"optical thickness {self.mean:.3g} on average, {self.maximum:.3g} at most, {100 * self.covered:.0f} % "
                f"covered; {self.points:,} points, {self.rays:,} rays in {self.seconds:.1f} s")


@dataclass(frozen=True)
class Dust:
    """tau: (n,) float32, optical thickness along the normal of what stays at each point; arrived: (n,) float32, of
    what fell there. `settings`, `seed`: what it was made with."""

    tau: np.ndarray
    arrived: np.ndarray
    statistics: Statistics
    settings: Settling = field(default_factory=Settling)
    seed: int = 0

    @property
    def grams(self) -> np.ndarray:
        """(n,) float32: areal mass in g/m^2."""
        return (self.tau / extinction_of(self.settings.extinction)).astype(np.float32)


def available() -> str:
    """Empty when dust can settle; otherwise one sentence that says why not (no working Embree layer)."""
    return rays.why_not()


def settle(surface: Mesh, points: Points | tuple | None = None, occluders: Iterable[Mesh] = (),
           settings: Settling | None = None, seed: int = 0, progress: Progress | None = None,
           cancel: Callable[[], bool] | None = None, threads: int = 0) -> Dust:
    """Dust on a surface among occluders, all in world space and metres.

    `points`: where; None: the surface's vertices, in their sequence. Otherwise Points, or (positions, normals), each
    (n, 3), such as `texel_points` makes. Vertices of no face get none. The same seed gives the same bytes, whatever
    `threads` (0: all). `progress(fraction, text)` is told how far it is; `cancel()` is asked often, and Cancelled
    raised when it says yes. Raises DustError, ValueError, and DustUnavailable without a working Embree layer."""
    started = clock.perf_counter()
    settings = Settling() if settings is None else settings
    check_seed(seed)
    check_threads(threads)
    layer = rays.layer()
    step = stepper("the settling of dust", progress, cancel)
    step(0.0, "reading the meshes")
    surface = checked_mesh(surface, "surface")
    others = [checked_mesh(mesh, f"occluders[{index}]") for index, mesh in enumerate(occluders)]
    others = [mesh for mesh in others if len(mesh.triangles)]
    frame = common_frame(surface)
    points = vertex_points(surface, portion(step, 0.0, 0.05)) if points is None else check_points(points)
    meshes = [(frame.floats(mesh.vertices), mesh.triangles) for mesh in (surface, *others)]
    used = meshes[0][0][used_vertices(surface)]
    build = portion(step, 0.05, 0.2)
    scene = layer.Scene(meshes, threads, lambda fraction: build(fraction, "sorting the faces"))
    fall = FallFrame.of(settings.gravity, settings.wind, settings.spread)
    sky = _Sky(layer, scene, fall, settings, frame, seed, step)
    positions, normals = frame.floats(points.positions), unit_normals(points.normals)
    share = sky.arrivals(positions, normals)
    stays = sky.retention(positions, normals, share)
    forward = dust_balance.trace(scene, sky.core, fall, used, [mesh[0] for mesh in meshes[1:]], frame.scale, seed)
    size = 0.2 * frame.scale if settings.patch is None else settings.patch
    left = patches(points.positions - frame.centre, settings.coverage, size, seed)
    step(1.0, f"{sky.rays:,} rays")
    arrived = share * settings.tau
    statistics = _statistics(points.areas, arrived, stays, left, settings, forward, sky.rays,
                             clock.perf_counter() - started)
    return Dust((arrived * stays * left).astype(np.float32), arrived.astype(np.float32), statistics, settings, seed)


class _Sky:
    """Rays from points to where dust comes from."""

    def __init__(self, layer, scene, fall: FallFrame, settings: Settling, frame, seed: int, step):
        self.core = fall.core(layer)
        self.rays = 0
        self._scene, self._fall, self._settings, self._scale, self._step = scene, fall, settings, frame.scale, step
        self._options = layer.Options(settings.rays, seed, settings.two_sided, OFFSET)
        self._sheltered = layer.Options(max(16, settings.rays // 4), seed ^ _SHELTER_STREAM, False, OFFSET)

    def arrivals(self, positions, normals) -> np.ndarray:
        """(n,) float64: the share of an open horizontal plane's dust that arrives at each point."""
        return self._chunks(positions, normals, self._settings.rays, portion(self._step, 0.2, 0.8), lambda *chunk:
                            self._scene.arrivals(self.core, *chunk, self._options))

    def retention(self, positions, normals, share) -> np.ndarray:
        """(n,) float64: the part of what arrives that does not slide off."""
        settings = self._settings
        cosine = np.clip(normals.astype(np.float64) @ self._fall.up, -1.0, 1.0)
        if settings.two_sided:
            normals = np.where(cosine[:, None] < 0.0, -normals, normals)
            cosine = np.abs(cosine)
        stays = _slope_retention(np.arccos(cosine), settings.repose, settings.repose_width)
        sliding = (stays < 1.0) & (share > 0.0)
        if settings.concavity > 0.0 and sliding.any():
            reach = 0.1 if settings.reach is None else settings.reach / self._scale
            # A point without a normal costs no rays; the others keep their numbers.
            needed = normals * sliding[:, None].astype(np.float32)
            exposure = self._chunks(positions, needed, max(16, settings.rays // 4), portion(self._step, 0.8, 0.95),
                                    lambda *chunk: self._scene.exposures(*chunk, self._sheltered, reach))
            stays += (1.0 - stays) * settings.concavity * (1.0 - exposure)
        return stays

    def _chunks(self, positions, normals, rays_a_point: int, step: Progress, trace) -> np.ndarray:
        values = np.empty(len(positions))
        size = max(1, CHUNK_RAYS // rays_a_point)
        for first in range(0, len(positions), size):
            step(first / len(positions), f"{self.rays:,} rays")
            part = slice(first, first + size)
            values[part], traced = trace(positions[part], normals[part], first)
            self.rays += traced
        return values


def _slope_retention(slope: np.ndarray, repose: float, width: float) -> np.ndarray:
    """1 on flat ground, 0 on what is too steep, smoothly between, one half at the angle of repose."""
    if repose >= math.pi:
        return np.ones_like(slope)
    if width == 0.0:
        return (slope <= repose).astype(np.float64)
    x = np.clip((slope - repose) / width + 0.5, 0.0, 1.0)
    return 1.0 - x * x * (3.0 - 2.0 * x)


def _statistics(areas, arrived, stays, left, settings: Settling, forward, traced: int, seconds: float) -> Statistics:
    tau = arrived * stays * left
    weights = np.ones(len(tau)) if areas is None or not areas.sum() > 0.0 else areas
    covered = tau > 0.01 * settings.tau
    mean, share = (float(np.average(x, weights=weights)) if len(tau) else 0.0 for x in (tau, covered))
    masses = (None,) * 4 if areas is None else tuple(
        float(areas @ x) for x in (arrived, tau, arrived * (1.0 - stays), arrived * stays * (1.0 - left)))
    fell, behind, stderr = forward.front, forward.back, forward.front_stderr
    if settings.two_sided:
        fell, behind, stderr = fell + behind, 0.0, forward.both_stderr
    amount = settings.tau
    return Statistics(
        points=len(tau), rays=traced + forward.grains, seconds=seconds, mean=mean,
        maximum=float(tau.max(initial=0.0)), covered=share, arrived=masses[0], deposited=masses[1], slid=masses[2],
        wiped=masses[3], launched=amount * forward.launched, fell=amount * fell, fell_stderr=amount * stderr,
        behind=amount * behind, stopped=amount * forward.stopped, missed=amount * forward.missed,
        grains=forward.grains, notes=tuple(_notes(masses[0], amount, fell, behind, stderr)))


def _notes(arrived: float | None, amount: float, fell: float, behind: float, stderr: float):
    if behind > 0.05 * (fell + behind):
        yield (f"{100.0 * behind / (fell + behind):.0f} % of the dust meets the back of faces, where none is laid: "
               "their normals may be turned, or the surface needs two sides")
    if arrived is not None and amount > 0.0 and abs(arrived / amount - fell) > 0.1 * fell + 5.0 * stderr:
        yield (f"the points sum to {arrived / (amount * fell) if fell > 0.0 else math.inf:.2f} times the dust that "
               "falls: the mesh is coarse, or its normals are not those of its faces")


def _is_number(value) -> bool:
    return isinstance(value, numbers.Real) and not isinstance(value, bool) and math.isfinite(value)


def _vector(value, name: str) -> np.ndarray:
    items = list(value) if isinstance(value, Sequence | np.ndarray) and not isinstance(value, str) else []
    if len(items) != 3 or not all(_is_number(item) and abs(item) <= 1e9 for item in items):
        raise DustError(f"{name} = {value!r}: must be three numbers")
    return np.array(items, np.float64)
