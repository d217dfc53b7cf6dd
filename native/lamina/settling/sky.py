# SPDX-License-Identifier: GPL-3.0-or-later
"""The sky over a surface: the dust that falls on points among triangles, and the share that stays."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..common.progress import Progress, portion
from ..kinds.dust import Settling
from . import balance, embree
from .balance import FallFrame
from .mesh import Mesh, Points, common_frame, unit_normals, used_vertices
from .patches import patches

CHUNK_RAYS = 1 << 21  # between two calls of `cancel`
# Distance of ray origins from the surface, relative to its size: 100 times the rounding of single precision, and less
# than 1 % of an edge in a mesh of a million faces.
OFFSET = 2.0**-17
_SHELTER_STREAM = 0x7368_656C_7465_7200  # a stream of random numbers of its own


@dataclass(frozen=True, eq=False)
class Laid:
    """arrived: (n,) optical thickness of the dust that falls; stays: (n,) share of it that does not slide; left: (n,)
    share of the rest that is not wiped off; back_share: (n,) share of `arrived` on the side opposite to the normal, or
    None."""

    arrived: np.ndarray
    stays: np.ndarray
    left: np.ndarray
    back_share: np.ndarray | None

    @property
    def tau(self) -> np.ndarray:
        return self.arrived * self.stays * self.left


class Sky:
    """Checked meshes as one scene, and rays through it. `rays` counts the rays."""

    def __init__(self, surface: Mesh, occluders: list[Mesh], settings: Settling, seed: int, threads: int,
                 step: Progress):
        layer = embree.layer()
        self.frame = common_frame(surface)
        self.rays = 0
        self.names = [mesh.name for mesh in occluders]
        self._settings, self._seed = settings, seed
        meshes = [(self.frame.floats(mesh.vertices), mesh.triangles) for mesh in (surface, *occluders)]
        self._used = meshes[0][0][used_vertices(surface)]
        self._scene = layer.Scene(meshes, threads, lambda fraction: step(fraction, "sorting the faces"))
        self._fall = FallFrame.of(settings.gravity, settings.wind, settings.spread)
        self._core = self._fall.core(layer)
        self._options = layer.Options(settings.rays, seed, settings.two_sided, OFFSET)
        self._sheltered = layer.Options(max(16, settings.rays // 4), seed ^ _SHELTER_STREAM, False, OFFSET)

    def grains(self) -> balance.Forward:
        """Grains traced from above."""
        return balance.trace(self._scene, self._core, self._fall, self._used, len(self.names), self.frame.scale,
                                  self._seed)

    def lay(self, points: Points, first: int, step: Progress) -> Laid:
        """Dust on checked points. Their random numbers are those of the point numbers from `first`."""
        settings = self._settings
        positions, normals = self.frame.floats(points.positions), unit_normals(points.normals)
        shares = self._chunks(positions, normals, first, settings.rays, portion(step, 0.0, 0.8), lambda *chunk:
                              self._scene.arrivals(self._core, *chunk, self._options))
        back_share = None
        if settings.two_sided:
            back, shares = shares[:, 1], shares.sum(axis=1)
            back_share = np.divide(back, shares, out=np.zeros_like(shares), where=shares > 0.0)
        stays = self._retention(positions, normals, shares, first, portion(step, 0.8, 1.0))
        size = 0.2 * self.frame.scale if settings.patch is None else settings.patch
        left = patches(points.positions - self.frame.centre, settings.coverage, size, self._seed)
        return Laid(shares * settings.tau, stays, left, back_share)

    def _retention(self, positions, normals, share, first: int, step: Progress) -> np.ndarray:
        """(n,) float64: the share of arriving dust that does not slide off."""
        settings = self._settings
        cosine = np.clip(normals.astype(np.float64) @ self._fall.up, -1.0, 1.0)
        if settings.two_sided:
            normals = np.where(cosine[:, None] < 0.0, -normals, normals)
            cosine = np.abs(cosine)
        stays = _slope_retention(np.arccos(cosine), settings.repose, settings.repose_width)
        sliding = (stays < 1.0) & (share > 0.0)
        if settings.concavity > 0.0 and sliding.any():
            reach = 0.1 if settings.reach is None else settings.reach / self.frame.scale
            # A point without a normal costs no rays; the numbers of other points do not change.
            needed = normals * sliding[:, None].astype(np.float32)
            exposure = self._chunks(positions, needed, first, max(16, settings.rays // 4), step, lambda *chunk:
                                    self._scene.exposures(*chunk, self._sheltered, reach))
            stays += (1.0 - stays) * settings.concavity * (1.0 - exposure)
        return stays

    def _chunks(self, positions, normals, number: int, rays_a_point: int, step: Progress, trace) -> np.ndarray:
        found = []
        size = max(1, CHUNK_RAYS // rays_a_point)
        for first in range(0, len(positions), size):
            step(first / len(positions), f"{self.rays:,} rays")
            part = slice(first, first + size)
            values, traced = trace(positions[part], normals[part], number + first)
            found.append(values.astype(np.float64))
            self.rays += traced
        return np.concatenate(found)


def _slope_retention(slope: np.ndarray, repose: float, width: float) -> np.ndarray:
    """1 on flat ground, 0 on steep slopes, smooth in between, one half at the angle of repose."""
    if repose >= math.pi:
        return np.ones_like(slope)
    if width == 0.0:
        return (slope <= repose).astype(np.float64)
    x = np.clip((slope - repose) / width + 0.5, 0.0, 1.0)
    return 1.0 - x * x * (3.0 - 2.0 * x)
