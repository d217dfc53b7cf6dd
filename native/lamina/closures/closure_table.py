# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of closures on the bake's grid of view and light directions, computed once per process."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .. import _core
from . import lobes
from .axes import column_angles
from .lobe import Geometry, Lobe
from .narrow_lobes import BROAD_ALPHA

# Nodes of the light grid (cosines, azimuths): the smallest grid whose fit error is within 2 % of the true value.
SMOOTH_NODES = {"preview": (16, 12), "final": (24, 16)}
# For lobes of alpha .03 and more: azimuths are dense near the mirror direction.
SHARP_NODES = {"preview": (40, 32), "final": (64, 48)}
DENSITY = 5.0
# For the halos of light scattered above a mirror, alpha .05 and more.
HALO_NODES, HALO_DENSITY = {"preview": (24, 16), "final": (40, 28)}, 3.0
# For brushed lobes of width .03 and more, which are long across or along the plane of incidence.
ORIENTED_NODES, ORIENTED_DENSITY = {"preview": (40, 28), "final": (56, 40)}, 3.0
# Grazing columns are sampled a little above the horizon, where slices are still defined.
LOWEST_COSINE = 6e-3
# In a sheet, the largest share of a tilted lobe beyond the horizon: small if Cycles loses this light, larger if the
# light stays as light on the other side.
MOST_LOST, MOST_STRAYED = 0.04, 0.1


def view_cosines() -> np.ndarray:
    """Cosines of the LUT's columns, shape (64,)."""
    return np.maximum(np.cos(column_angles()), LOWEST_COSINE)


@dataclass(frozen=True, eq=False)
class LightGrid:
    """A product grid over the light's hemisphere, for azimuths from 0 to pi; the other half is symmetric.

    `solid_angle` is flat, cosines major, and integrates over the whole hemisphere."""

    mu: np.ndarray
    dphi: np.ndarray
    solid_angle: np.ndarray


def light_grid(cosines: int, azimuths: int, density: float = 0.0) -> LightGrid:
    """Gauss-Legendre in the cosine and in the azimuth dphi = pi sinh(density x) / sinh(density), x in (0, 1)."""
    x, wx = np.polynomial.legendre.leggauss(cosines)
    y, wy = np.polynomial.legendre.leggauss(azimuths)
    mu, y = 0.5 * (x + 1.0), 0.5 * (y + 1.0)
    dphi, slope = math.pi * y, np.full(azimuths, math.pi)
    if density > 0.0:
        dphi = math.pi * np.sinh(density * y) / math.sinh(density)
        slope = math.pi * density * np.cosh(density * y) / math.sinh(density)
    return LightGrid(mu, dphi, np.outer(0.5 * wx, wy * slope).ravel())


def _dense_both_ways(cosines: int, azimuths: int) -> LightGrid:
    """A light grid dense about the mirror direction and about the viewer, half of the azimuths for each."""
    front = light_grid(cosines, azimuths // 2, DENSITY)
    weight = 0.5 * front.solid_angle.reshape(cosines, -1)
    return LightGrid(front.mu, np.concatenate([0.5 * front.dphi, math.pi - 0.5 * front.dphi[::-1]]),
                     np.concatenate([weight, weight[:, ::-1]], axis=1).ravel())


@functools.lru_cache(maxsize=2)
def oriented_grid(quality: str) -> LightGrid:
    """The light grid for anisotropic stacks, whose slices are not symmetric: azimuths from -pi to pi."""
    cosines, azimuths = ORIENTED_NODES[quality]
    half = light_grid(cosines, azimuths, ORIENTED_DENSITY)
    weight = 0.5 * half.solid_angle.reshape(cosines, azimuths)
    return LightGrid(half.mu, np.concatenate([-half.dphi[::-1], half.dphi]),
                     np.concatenate([weight[:, ::-1], weight], axis=1).ravel())


@functools.lru_cache(maxsize=4)
def grid_for(quality: str, narrowest: float | None, halo: bool = False, retro: bool = False) -> LightGrid:
    """The light grid for slices whose narrowest lobe has this alpha, or None without lobes; `halo`: with a halo;
    `retro`: with a lobe about the viewer."""
    if narrowest is not None and narrowest < BROAD_ALPHA:
        cosines, azimuths = SHARP_NODES[quality]
        return _dense_both_ways(cosines, azimuths) if retro else light_grid(cosines, azimuths, density=DENSITY)
    return light_grid(*HALO_NODES[quality], density=HALO_DENSITY) if halo else light_grid(*SMOOTH_NODES[quality])


@dataclass(frozen=True, eq=False)
class Closures:
    """Closures of one kind on a grid and some view columns: their values [column, closure, light], their directional
    albedos [column, closure], and the core's table of both."""

    ids: list[str]
    grid: LightGrid
    values: np.ndarray
    albedo: np.ndarray
    table: _core.ClosureTable


@functools.lru_cache(maxsize=6)
def dictionary(kind: str, grid: LightGrid, mixed: bool, stride: int) -> Closures:
    """All closures of the dictionary of that kind, "reflection" or "transmission", to choose from. `mixed`: for a
    sheet, where both kinds meet, see `_available`."""
    return _tabulated([lobe.id for lobe in lobes.DICTIONARY if lobe.side == kind], grid, mixed, stride)


@functools.lru_cache(maxsize=4)
def with_more(kind: str, grid: LightGrid, mixed: bool, stride: int, more: tuple[str, ...]) -> Closures:
    """The dictionary's closures and those made for one stack."""
    whole = dictionary(kind, grid, mixed, stride)
    return _tabulated(more, grid, mixed, stride, whole) if more else whole


@functools.lru_cache(maxsize=16)
def only(grid: LightGrid, mixed: bool, ids: tuple[str, ...]) -> Closures:
    """These closures only, in this order, at all columns, for the fit."""
    return _tabulated(ids, grid, mixed, 1)


def _tabulated(ids: Sequence[str], grid: LightGrid, mixed: bool, stride: int,
               first: Closures | None = None) -> Closures:
    values, albedo = sampled(ids, grid, stride), column_albedos(tuple(ids), stride)
    if mixed:
        available = _available(ids, albedo)
        # Light that strays beyond the horizon counts, so that the sum of both sides is exact.
        strays = np.array([lobes.by_id(name).strays for name in ids])
        values, albedo = values * available[..., None], np.where(strays, 1.0, albedo) * available
    if first is not None:
        ids = [*first.ids, *ids]
        values, albedo = (np.concatenate(pair, axis=1) for pair in ((first.values, values), (first.albedo, albedo)))
    albedo = np.ascontiguousarray(albedo)
    return Closures(list(ids), grid, values, albedo, _core.ClosureTable(values, grid.solid_angle, albedo))


@functools.lru_cache(maxsize=16)
def column_albedos(ids: tuple[str, ...], stride: int = 1) -> np.ndarray:
    """Directional albedos [column, closure] on the closure's own side of the horizon. They have their own grids: finer
    for closures with edges, denser near the mirror direction for narrow lobes. A cone that is wholly above the horizon
    is integrated in closed form, because the edge of a narrow cone is too sharp for a grid."""
    dense, mu_o = light_grid(96, 64, DENSITY), view_cosines()[::stride]
    narrow = [name for name in ids if lobes.by_id(name).narrow]
    known = dict(zip(narrow, (_sample(narrow, dense, mu_o) @ dense.solid_angle).T, strict=True)) if narrow else {}
    return np.stack([known[name] if name in known else _albedo(lobes.by_id(name), mu_o) for name in ids], axis=1)


def _albedo(lobe: Lobe, mu_o: np.ndarray) -> np.ndarray:
    """Directional albedos, exact at the views where the lobe is a cone wholly above the horizon."""
    found = np.empty(len(mu_o))
    crosses = np.ones(len(mu_o), dtype=bool)
    if lobe.cone is not None:
        _, height = Geometry(mu_o, mu_o, 0.0).normal(lobe.node.normal)
        crosses = np.arcsin(np.minimum(height, 1.0)) < lobe.cone.reach
        found[~crosses] = lobe.cone.whole
    if crosses.any():
        found[crosses] = lobes.directional_albedo(lobe, mu_o[crosses])
    return found


def _available(ids: Sequence[str], albedo: np.ndarray) -> np.ndarray:
    """1 where a closure may be part of a sheet's mixture, [column, closure]. Tilted lobes cross the horizon at oblique
    views, and are excluded where too much of them would be beyond. There Cycles 4.5 evaluates tilted Diffuse, Toon and
    Translucent closures without sampling them, and samples Hair closures without evaluating them. Below the horizon
    Cycles also evaluates Hair closures behind the viewer, without sampling them; the same limit applies to that
    share."""
    most = np.array([(MOST_STRAYED if lobes.by_id(name).strays else MOST_LOST) if lobes.by_id(name).leans else 1.0
                     for name in ids])
    return np.where((albedo < 1.0 - most) | (albedo > 1.0 + most), 0.0, 1.0)


def sampled(ids: Sequence[str], grid: LightGrid, stride: int) -> np.ndarray:
    """Values of closures at every `stride`-th column, [column, closure, light]."""
    return _sample(ids, grid, view_cosines()[::stride])


def _sample(ids: Sequence[str], grid: LightGrid, mu_o: np.ndarray) -> np.ndarray:
    """Values [column, closure, light]."""
    shape = (len(mu_o), len(grid.solid_angle))
    args = (mu_o[:, None, None], grid.mu[None, :, None], grid.dphi[None, None, :])
    return np.stack([lobes.by_id(name).evaluate(*args).reshape(shape) for name in ids], axis=1)
