# SPDX-License-Identifier: GPL-3.0-or-later
"""The sky over a surface: from rays to the dust that falls on points, and the share that stays."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..kinds.dust import Settling
from . import balance
from .balance import FallFrame
from .mesh import Mesh, Points, common_frame, unit_normals, used_vertices
from .patches import patches
from .rays import Place, Starts, Traced, reach_of
from .shelter import sheltering


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
    """Checked meshes under falling dust. `place`: what rays are traced in; `names`: of its occluders."""

    def __init__(self, surface: Mesh, occluders: list[Mesh], settings: Settling, seed: int):
        self.frame = common_frame(surface)
        self._fall = FallFrame.of(settings.gravity, settings.wind, settings.spread)
        occluders = [mesh for mesh in occluders if len(mesh.triangles)]
        occluders = sheltering(surface, occluders, self._fall, reach_of(settings, self.frame.scale))
        self.names = [mesh.name for mesh in occluders]
        self._settings, self._seed = settings, seed
        self.place = Place(surface, occluders, self.frame, self._fall, settings, seed)

    def window(self) -> balance.Window:
        """Where grains start that are traced from above."""
        surface = self.place.surface
        used = self.frame.floats(surface.vertices)[used_vertices(surface)]
        return balance.window_over(used, self._fall, self.frame.scale)

    def starts(self, points: Points) -> tuple[Starts, np.ndarray]:
        """Where the rays of checked points start, and (n,) float64, the share of dust that stays by inclination."""
        positions, normals = self.frame.floats(points.positions), unit_normals(points.normals)
        cosine = np.clip(normals.astype(np.float64) @ self._fall.up, -1.0, 1.0)
        side = np.ones(len(positions), np.int8)
        if self._settings.two_sided:
            side[cosine < 0.0] = -1
            cosine = np.abs(cosine)
        stays = _slope_retention(np.arccos(cosine), self._settings.repose, self._settings.repose_width)
        return Starts(positions, normals, side * (stays < 1.0)), stays

    def laid(self, points: Points, stays: np.ndarray, traced: Traced) -> Laid:
        """The dust on checked points, from `starts` and their rays."""
        settings = self._settings
        shares, back_share = traced.shares.astype(np.float64), None
        if settings.two_sided:
            back, shares = shares[:, 1], shares.sum(axis=1)
            back_share = np.divide(back, shares, out=np.zeros_like(shares), where=shares > 0.0)
        stays = stays + (1.0 - stays) * settings.concavity * (1.0 - traced.exposures.astype(np.float64))
        size = 0.2 * self.frame.scale if settings.patch is None else settings.patch
        left = patches(points.positions - self.frame.centre, settings.coverage, size, self._seed)
        left = left * (1.0 - settings.rubbed * traced.convexities.astype(np.float64))
        return Laid(shares * settings.tau, stays, left, back_share)


def _slope_retention(slope: np.ndarray, repose: float, width: float) -> np.ndarray:
    """1 on flat ground, 0 on steep slopes, smooth in between, one half at the angle of repose."""
    if repose >= math.pi:
        return np.ones_like(slope)
    if width == 0.0:
        return (slope <= repose).astype(np.float64)
    x = np.clip((slope - repose) / width + 0.5, 0.0, 1.0)
    return 1.0 - x * x * (3.0 - 2.0 * x)
