# SPDX-License-Identifier: GPL-3.0-or-later
"""The dictionary's closures on the bake's grid of view and light directions, made once per process."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from . import _core, lobes
from .lut import column_angles

# Nodes of the light grid (cosines, azimuths): the smallest whose fit error is within 2 % of its true value.
LIGHT_NODES = {"preview": (16, 12), "final": (24, 16)}
# Grazing columns are sampled a little above the horizon, where slices are still defined.
LOWEST_COSINE = 6e-3


def view_cosines() -> np.ndarray:
    """Cosines of the LUT's columns, shape (64,)."""
    return np.maximum(np.cos(column_angles()), LOWEST_COSINE)


@dataclass(frozen=True)
class LightGrid:
    """A product grid over the light's hemisphere; the azimuth's other half is its mirror image.

    `solid_angle` is flat, cosines major, and integrates over the whole hemisphere."""

    mu: np.ndarray
    dphi: np.ndarray
    solid_angle: np.ndarray


def light_grid(cosines: int, azimuths: int) -> LightGrid:
    """Gauss-Legendre in the cosine and in the azimuth."""
    x, wx = np.polynomial.legendre.leggauss(cosines)
    y, wy = np.polynomial.legendre.leggauss(azimuths)
    mu, dphi = 0.5 * (x + 1.0), 0.5 * math.pi * (y + 1.0)
    solid_angle = np.outer(0.5 * wx, math.pi * wy).ravel()
    return LightGrid(mu, dphi, solid_angle)


@dataclass(frozen=True)
class Closures:
    """The dictionary's closures of one kind ("reflection" or "transmission") on the grid: the core's table of
    them, and their directional albedos [column, closure]."""

    ids: list[str]
    grid: LightGrid
    table: _core.ClosureTable
    albedo: np.ndarray
    kind: str
    quality: str

    def only(self, ids: Iterable[str]) -> Closures:
        """Just these, in that order: a fit with closures that are known needs no inner products with others."""
        return _only(self.kind, self.quality, tuple(ids))


@functools.lru_cache(maxsize=4)
def closures(kind: str, quality: str) -> Closures:
    """The closures of that kind; made at the first call, which takes about a second."""
    chosen = tuple(lobe for lobe in lobes.DICTIONARY if lobe.side == kind)
    grid = light_grid(*LIGHT_NODES[quality])
    albedo = _albedos(kind)
    table = _core.ClosureTable(_sample(chosen, view_cosines(), grid), grid.solid_angle, albedo)
    return Closures([lobe.id for lobe in chosen], grid, table, albedo, kind, quality)


@functools.lru_cache(maxsize=8)
def _only(kind: str, quality: str, ids: tuple[str, ...]) -> Closures:
    chosen, grid = [lobes.by_id(name) for name in ids], light_grid(*LIGHT_NODES[quality])
    whole = closures(kind, quality)
    albedo = np.ascontiguousarray(whole.albedo[:, [whole.ids.index(name) for name in ids]])
    table = _core.ClosureTable(_sample(chosen, view_cosines(), grid), grid.solid_angle, albedo)
    return Closures(list(ids), grid, table, albedo, kind, quality)


@functools.lru_cache(maxsize=2)
def _albedos(kind: str) -> np.ndarray:
    """Directional albedos [column, closure], on a grid of their own: closures with edges need a finer one."""
    chosen = [lobe for lobe in lobes.DICTIONARY if lobe.side == kind]
    return np.stack([lobes.directional_albedo(lobe, view_cosines()) for lobe in chosen], axis=1)


def _sample(chosen, mu_o, grid: LightGrid) -> np.ndarray:
    """Values [column, closure, light]."""
    shape = (len(mu_o), len(grid.solid_angle))
    args = (mu_o[:, None, None], grid.mu[None, :, None], grid.dphi[None, None, :])
    return np.stack([lobe.evaluate(*args).reshape(shape) for lobe in chosen], axis=1)
