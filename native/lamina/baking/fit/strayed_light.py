# SPDX-License-Identifier: GPL-3.0-or-later
"""Light of a sheet's transmission lobes that strays above the horizon, and its effect in Cycles.

Cycles samples a Hair lobe in all directions ahead of the viewer, also above the horizon, but evaluates it only below.
For a sampled direction Cycles divides the sum of all closures' values by the sum of their densities, each closure
with its share of the samples (the balance heuristic). Consider a direction above the horizon, a lobe of density h and
weight w with the mean W over R, G and B, and other closures of total value F and density P. Cycles scores
(w h + F) / (W h + P), while the lobe alone would score w / W. Under a white sky the error of the lobe's strayed light
w h is

    gain = h (W F - w P) / (W h + P)

integrated over the upper hemisphere. The gain is 0 where F / P = w / W: the reflected light has the same colour as the
transmitted light, and is sampled in proportion to its value. Elsewhere the weights of transmitted closures are scaled
so that the sum of both sides is exact again."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence

import numpy as np

from ...closures import lobes
from ...closures.closure_table import DENSITY, LightGrid, light_grid, only, view_cosines
from ...closures.lobes import directional_albedo, fresnel_ggx, ggx
from .mixture import Mixture, reweighted
from .slices import Slices

# Strayed light is smooth, except that it rises towards the horizon ahead of the viewer.
NODES = (12, 12)
# Each round multiplies the error by about the share of light that strays.
ROUNDS, NEGLIGIBLE = 10, 1e-6
# Largest relative change of a transmitted slice's weights. More is needed only where the sheet transmits far less of a
# colour than it reflects.
MOST_CHANGE = 0.25
# Cycles reads the mean Fresnel factor of a Principled closure's facets from a table. Its number of nodes, in the view
# cosine and in the square root of (n - 1) / (n + 1):
FRESNEL_NODES = 16


def compensated(reflected: Mixture, through: Mixture, wanted: Slices, grid: LightGrid) -> Mixture:
    """The transmitted mixture, scaled so that a white sky shows the exact sum of both sides' albedos. Where this would
    change a slice by more than MOST_CHANGE, part of the error remains."""
    above, weights, before = _reflected(reflected.weights, reflected.closures), through.weights, 1.0
    whole = np.where(wanted.albedo > 0.0, wanted.albedo, np.inf)
    for _ in range(ROUNDS):
        gain = _gains(above, weights, through.closures)
        share = np.clip(1.0 - gain / whole, 1.0 - MOST_CHANGE, 1.0 + MOST_CHANGE)
        if np.all(np.abs(share - before) <= NEGLIGIBLE):
            break
        before, weights = share, through.weights * share[:, None]
    return through if weights is through.weights else reweighted(through, weights, wanted, grid, True)


def strayed_report(fitted: Mapping[str, Mixture], seen: dict[str, Slices], stated: np.ndarray) -> dict:
    """Errors by strayed light of the mixtures `fitted` to the slices `seen`, by kind, in the columns `stated`: the
    largest `share` of a view's light that strays above the horizon, and the largest relative `furnace_error` of the
    light under a white sky against the exact sum of reflection and transmission."""
    closures = [name for part in fitted.values() for name in part.closures]
    weights = np.concatenate([part.weights for part in fitted.values()], axis=1)
    total = sum(one.whole for one in seen.values())
    share, known = np.zeros_like(total), total > 1e-12
    grid = _grid()
    for name in closures:
        if _side(name) == "transmission" and lobes.by_id(name).strays:
            share += weights[:, closures.index(name)] * (_strayed(name) @ grid.solid_angle)
    over = gains(weights, closures) - sum(one.albedo for one in seen.values())
    for kind in seen:
        table = only(_grid(), True, tuple(fitted[kind].closures))
        over = over + np.einsum("skrxc,ck->srxc", fitted[kind].weights, table.albedo)
    relative = [np.where(known, part, 0.0) / np.where(known, total, 1.0) for part in (share, np.abs(over))]
    return dict(zip(("share", "furnace_error"), (float(part[..., stated].max()) for part in relative), strict=True))


def gains(weights: np.ndarray, closures: Sequence[str]) -> np.ndarray:
    """Excess over the exact albedo under a white sky, [side, row, channel, column], for `weights` [side, closure, row,
    channel, column] of one channel or three."""
    return _gains(_reflected(weights, closures), weights, closures)


def _reflected(weights: np.ndarray, closures: Sequence[str]):
    """Total value F [side, row, channel, column, light] and density P, the same in all channels, of reflecting
    closures."""
    names = tuple(name for name in closures if _side(name) == "reflection")
    values, densities = _above(names)
    own = weights[:, [closures.index(name) for name in names]]
    value = np.einsum("skrxc,ckl->srxcl", own, values, optimize=True)
    return value, np.einsum("skrc,ckl->srcl", own.mean(axis=3), densities, optimize=True)[:, :, None]


def _gains(reflected, weights: np.ndarray, closures: Sequence[str]) -> np.ndarray:
    value, density = reflected
    found = np.zeros(value.shape[:-1])
    for k, name in enumerate(closures):
        if _side(name) == "transmission" and lobes.by_id(name).strays:
            weight = weights[:, k, ..., None]
            mean, strayed = weight.mean(axis=2, keepdims=True), _strayed(name)
            total = mean * strayed + density
            per_sample = strayed / np.where(total > np.finfo(float).tiny, total, 1.0)  # a denormal quotient overflows
            found += (per_sample * (mean * value - weight * density)) @ _grid().solid_angle
    return found


def _side(name: str) -> str:
    """"reflection" or "transmission"; "" for a closure of delta light."""
    return "" if name == "transparent" or name.startswith("mirror:") else lobes.by_id(name).side


@functools.lru_cache(maxsize=1)
def _grid():
    return light_grid(*NODES, DENSITY)


def _directions():
    grid = _grid()
    return view_cosines()[:, None, None], grid.mu[None, :, None], grid.dphi[None, None, :]


@functools.lru_cache(maxsize=64)
def _strayed(name: str) -> np.ndarray:
    """Density above the horizon [column, light]."""
    strayed = lobes.by_id(name).strayed
    assert strayed is not None
    return strayed(*_directions()).reshape(len(view_cosines()), -1)


@functools.lru_cache(maxsize=8)
def _above(names: tuple[str, ...]):
    """(values, densities), each [column, closure, light], of reflecting closures of unit weight. Cycles samples a
    Principled closure with a probability in proportion to its weight times the mean Fresnel factor of its facets, and
    any other closure in proportion to its weight."""
    table = only(_grid(), True, names)
    shape = (len(view_cosines()), -1)
    densities = table.values.copy()
    for k, name in enumerate(names):
        lobe = lobes.by_id(name)
        if lobe.density is not None:
            share = (table.albedo[:, k] > 0.0).astype(float)
            if lobe.node.type == "ShaderNodeBsdfPrincipled":
                share = _mean_fresnel(lobe.node.inputs["IOR"], lobe.node.inputs["Roughness"])
            densities[:, k] = lobe.density(*_directions()).reshape(shape) * share[:, None]
    return table.values, densities


@functools.lru_cache(maxsize=64)
def _mean_fresnel(ior: float, roughness: float) -> np.ndarray:
    """(F - F0) / (1 - F0) averaged over the visible facets of each column, linear between the nodes of Cycles'
    table."""
    place = math.sqrt((ior - 1.0) / (ior + 1.0)) * (FRESNEL_NODES - 1)
    node = min(int(place), FRESNEL_NODES - 2)
    mu = np.linspace(0.0, 1.0, FRESNEL_NODES)
    mu[0] = 1e-3
    bare = directional_albedo(ggx(roughness), mu)

    def at(node):
        root = (node / (FRESNEL_NODES - 1)) ** 2
        if root in (0.0, 1.0):
            return np.full(FRESNEL_NODES, root)
        return directional_albedo(fresnel_ggx((1.0 + root) / (1.0 - root), roughness), mu) / bare

    mean = at(node) * (1.0 - (place - node)) + at(node + 1) * (place - node)
    return np.interp(view_cosines(), mu, mean)
