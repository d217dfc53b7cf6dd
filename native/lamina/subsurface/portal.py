# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables for a tabulated BSSRDF of a stack, rendered in Cycles by its Ray Portal BSDF.

The portal moves the camera ray to a source below the shading point, with a direction uniform over the upper hemisphere.
The ray hits the surface from inside and evaluates ordinary closures there. On a plane, the hits of a source at depth
z have the density z / (2 pi (z^2 + r^2)^1.5) over the distance r. A weight that depends on r turns the mean of these
densities over all depths into the stack's profile. On a curved surface each ray still hits the surface, so no light is
lost."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..common.by_content import ByContent
from ..common.progress import Progress, portion, stepper
from ..lateral.searchlight import Searchlight, searchlight
from ..material.any_stack import AnyStack, as_stack
from ..solver.solve import ScatteringFunction, solve
from . import entry_lobes, single_scattering
from .entry_lobes import EntryLobes
from .node_parameters import LEAST_IOR
from .single_scattering import SingleScattering
from .stack_nodes import boundary_on_top, require_finite_distance

DEPTHS, WEIGHTS, VIEWS = 1024, 1024, 256  # sizes of the tables
# Ratio of source depth to exit distance at equal quantiles. The profile of an isotropic half-space equals that of
# sources with absorption. Up to the median the depths of these sources have this ratio (albedo .9).
DEPTH_SHARE = 0.9


@dataclass(frozen=True, eq=False)
class PortalTables(ByContent):
    """Tables of the portal. Lengths in millimetres.

    `depths`, shape (DEPTHS,): equally likely depths of sources. `weights`, (WEIGHTS, channels): weight of a ray by the
    distance r on the plane, at r / (r + scale) = k / (WEIGHTS - 1). `views`, (VIEWS, channels): share of the light
    entering below the boundary that goes through the portal, at the view cosine k / (VIEWS - 1). `single`: the medium
    whose single scattering does not go through the portal, or None. `entry`: closures for the directions from which
    light enters. `ior`, `roughness`: the boundary on top, ior 1.01 for none. `albedo`, `distance`, (channels,): exit
    albedo and mean exit distance of all light without the boundary's reflection, for a view along the normal.
    `profile_error`: largest error, from the tables' resolution, of the flux within any distance, relative to the total
    flux."""

    depths: np.ndarray
    weights: np.ndarray
    scale: float
    views: np.ndarray
    single: SingleScattering | None
    entry: EntryLobes
    ior: float
    roughness: float
    albedo: np.ndarray
    distance: np.ndarray
    profile_error: float

    @property
    def has_boundary(self) -> bool:
        """True if the material needs a Glossy closure for a boundary on top."""
        return self.ior > LEAST_IOR

    @property
    def report(self) -> str:
        """The predicted result of the tables and its error, as one sentence."""
        ways = ", ".join(f"{way:.3g}" for way in self.distance)
        return (f"Portal: on a flat surface the tables keep the flux within any distance to "
                f"{max(100.0 * self.profile_error, 0.01):.2g} %, mean exit distance {ways} mm.")


def portal_tables(stack: AnyStack, quality: str = "final", progress: Progress | None = None,
                  cancel: Callable[[], bool] | None = None) -> PortalTables:
    """Tables with which Cycles' Ray Portal BSDF renders the lateral light transport of a stack.

    If the topmost layer is a deep medium without a boundary, with isotropic scattering or Henyey and Greenstein's phase
    function, the portal leaves out single scattering, which Cycles' volume rendering adds. Arguments and errors are
    those of lamina.subsurface_nodes."""
    stack = as_stack(stack)
    step = stepper("the portal", progress, cancel)
    beam = searchlight(stack, 1.0, quality, progress=portion(step, 0.0, 0.8), cancel=cancel)
    on_top, ior, roughness = boundary_on_top(stack, 1.0, quality)
    distance = require_finite_distance(beam, on_top)
    single = single_scattering.of_stack(stack)
    scale = float(np.median(distance))
    r = _distances(scale)
    light = np.stack([_profile(beam, c, r, single) for c in range(stack.channels)], axis=1)
    within = _within(r, light)
    ranks = (np.arange(DEPTHS) + 0.5) / DEPTHS
    depths = DEPTH_SHARE * np.interp(ranks, (within / within[-1]).mean(axis=1), r)
    weights, error = _weights(depths, scale, r, light, within)
    step(0.9, "Views")
    solved = solve(stack, quality)
    views = _views(solved, single, quality)
    entry = entry_lobes.fit(_inside(solved, entry_lobes.COSINES, single, quality)[0])
    step(1.0, "Done")
    return PortalTables(depths, weights, scale, views, single, entry, ior, roughness,
                        (beam.reflectance - on_top) / (1.0 - on_top), distance, error)


def _distances(scale: float) -> np.ndarray:
    """Nodes for integrals over the plane: uniform in r / (r + scale)."""
    u = (np.arange(8 * WEIGHTS) + 0.5) / (8 * WEIGHTS)
    return scale * u / (1.0 - u)


def _rings(r: np.ndarray) -> np.ndarray:
    """Areas of the rings around the nodes r of _distances."""
    scale = r[0] * (2.0 * len(r) - 1.0)  # r[0] = scale u / (1 - u) with u = .5 / len(r)
    edges = np.arange(len(r) + 1) / len(r)
    edges = scale * edges[:-1] / (1.0 - edges[:-1])
    return math.pi * np.diff(np.append(edges, 2.0 * r[-1] - edges[-1]) ** 2)


def _within(r: np.ndarray, density: np.ndarray) -> np.ndarray:
    """Flux within the outer edge of each ring."""
    return np.cumsum(density * _rings(r)[:, None], axis=0)


def _profile(beam: Searchlight, index: int, r: np.ndarray, single: SingleScattering | None) -> np.ndarray:
    """Flux density at r of the light through the portal, in one channel."""
    density = beam.profile(r)
    density = density if density.ndim == 1 else density[:, index]
    if single is not None:
        density = density - single.density(r, index)
    return np.maximum(density, 0.0)


def _weights(depths: np.ndarray, scale: float, r: np.ndarray, light: np.ndarray,
             within: np.ndarray) -> tuple[np.ndarray, float]:
    """(weights at WEIGHTS distances, largest error of the flux within any distance)."""
    shown = np.mean(depths / (2.0 * math.pi * np.hypot(depths, r[:, None]) ** 3), axis=1)
    exact = light / within[-1] / shown[:, None]
    u, places = r / (r + scale), np.linspace(0.0, 1.0, WEIGHTS)
    table = np.stack([np.interp(places, u, column) for column in exact.T], axis=1)
    read = np.stack([np.interp(u, places, column) for column in table.T], axis=1)
    reached = _within(r, read * shown[:, None])
    table = table / reached[-1]
    return table, float(np.max(np.abs(reached / reached[-1] - within / within[-1])))


def _views(solved: ScatteringFunction, single: SingleScattering | None, quality: str) -> np.ndarray:
    """Share of the light entering below the boundary that goes through the portal, by view cosine."""
    cosines = np.linspace(0.0, 1.0, VIEWS)
    cosines[0] = 0.25 * cosines[1]
    inside, on_top = _inside(solved, cosines, single, quality)
    return np.clip(inside / np.maximum(1.0 - on_top, 1e-6), 0.0, 1.0)


def _inside(solved: ScatteringFunction, cosines: np.ndarray, single: SingleScattering | None,
            quality: str) -> tuple[np.ndarray, np.ndarray]:
    """(light through the portal, light that a boundary on top reflects), as shares of the incident light, by view
    cosine or, by reciprocity, by incidence cosine."""
    on_top = boundary_on_top(solved.stack, cosines, quality)[0]
    inside = solved.reflectance(cosines) - on_top
    if single is not None:
        inside = inside - single.reflectance(cosines)
    return np.maximum(inside, 0.0), on_top
