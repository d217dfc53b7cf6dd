# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables for a tabulated BSSRDF of a stack, rendered in Cycles by its Ray Portal BSDF.

The portal moves the camera ray to a source below the shading point, with a random direction. The ray hits the surface
from inside and evaluates ordinary closures there. Weights turn the mean density of hits of all depths on a plane into
the stack's profile. A hit on the plane has the distance r from the shading point; the ray from depth z has the length
t, where t^2 = r^2 + z^2.

* With the first orders of scattering by a volume, directions follow Lambert's law, with the density z^2 / (pi t^4) of
  hits: steep rays are likely, as distant exits are rare. The weight depends on r. Each ray hits a curved surface, too,
  so a curved surface reflects as much light as a plane, unless the source lies beyond the centre of the body.
* Otherwise directions are uniform, with the density z / (2 pi t^3), and the hit is weighted where the ray leaves. The
  weight contains the factor (1 + k t) exp(-k (t - z)) for a diffusing medium with the decay k (see source_depths), and
  the ratio of z / (2 pi t^3) to the density of hits on the actual surface. Ways through a convex body are shorter than
  below a plane, so more light leaves."""

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
from . import entry_lobes, first_orders, plane_rings, source_depths
from .entry_lobes import EntryLobes
from .first_orders import FirstOrders
from .node_parameters import LEAST_IOR
from .plane_rings import LEAST_FLUX
from .source_depths import Sources, flux_density
from .stack_nodes import boundary_on_top, require_finite_distance

DEPTHS, WEIGHTS, VIEWS = 1024, 1024, 256  # sizes of the tables
LEAST_COSINE = -0.05  # of rays that are weighted at the exit: a convex surface reaches below the source
LEAST_LIGHT = 1e-4  # through the portal: less, as in a dark channel after the first orders, has no exact direction
LARGEST_WEIGHT = 2.0  # of rays that are weighted at the exit, by distance
LEAST_ENTERING, MOST_ENTERING = 0.1, 0.85  # limits of the share of the views that enter the volume
COST = 1.6  # time of a path in the volume, in paths through the portal


@dataclass(frozen=True, eq=False)
class PortalTables(ByContent):
    """Tables of the portal. Lengths in millimetres.

    `depths`, shape (DEPTHS,): equally likely depths of sources. `shares`, (DEPTHS, channels): weight of a ray by the
    depth of its source. `decay`, (channels,): decay k of the light along a ray, 1/mm, 0 for none. `weights`,
    (WEIGHTS, channels): weight of a ray by the distance r on the plane, at r / (r + scale) = k / (WEIGHTS - 1).
    `views`, (VIEWS, channels): share of the light entering below the boundary that goes through the portal, at the view
    cosine k / (VIEWS - 1). `first`: the orders of scattering that do not go through the portal, or None. `entering`:
    share of the views that enter the volume for these orders; the others take the portal. `entry`: closures for the
    directions from which light enters. `ior`, `roughness`: the boundary on top, ior 1.01 for none. `albedo`,
    `distance`, (channels,): exit albedo and mean exit distance of all light without the boundary's reflection, for a
    view along the normal. `profile_error`: largest error, from the tables' resolution, of the flux within any distance,
    relative to the total flux."""

    depths: np.ndarray
    shares: np.ndarray
    decay: np.ndarray
    weights: np.ndarray
    scale: float
    views: np.ndarray
    first: FirstOrders | None
    entering: float
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
    def weighted_at_exit(self) -> bool:
        """True if rays are weighted where they leave the surface."""
        return self.first is None

    @property
    def least_cosine(self) -> float:
        """The smallest cosine between a source's ray and the normal."""
        return LEAST_COSINE if self.weighted_at_exit else 0.0

    @property
    def report(self) -> str:
        """The predicted result of the tables and its error, as one sentence."""
        ways = ", ".join(f"{way:.3g}" for way in self.distance)
        flat = (f"Portal: on a flat surface the tables keep the flux within any distance to "
                f"{max(100.0 * self.profile_error, 0.01):.2g} %, mean exit distance {ways} mm.")
        if self.first is None:
            return flat
        return f"{flat} Light is scattered up to {self.first.count} times in the volume, the rest takes the portal."


def portal_tables(stack: AnyStack, quality: str = "final", progress: Progress | None = None,
                  cancel: Callable[[], bool] | None = None, scatterings: int | None = None) -> PortalTables:
    """Tables with which Cycles' Ray Portal BSDF renders the lateral light transport of a stack.

    If the topmost layer is a deep medium without a boundary, with isotropic scattering or Henyey and Greenstein's phase
    function, the portal leaves out the first orders of scattering, which Cycles' volume rendering adds. `scatterings`:
    their number, 1 to 14; by default 2 for isotropic scattering, and more for forward scattering. Fewer render in less
    time and with less noise, and show less of the sun's direction on curved bodies. Beyond an anisotropy of .9 there is
    always one. Other arguments and errors are those of lamina.subsurface_nodes."""
    stack = as_stack(stack)
    first = first_orders.of_stack(stack, scatterings)
    step = stepper("the portal", progress, cancel)
    beam = searchlight(stack, 1.0, quality, progress=portion(step, 0.0, 0.8), cancel=cancel)
    on_top, ior, roughness = boundary_on_top(stack, 1.0, quality)
    distance = require_finite_distance(beam, on_top)
    scale = float(np.median(distance))
    r = plane_rings.distances(scale, 8 * WEIGHTS)
    light = _profile(beam, r, first)
    sources = source_depths.fit(r, light, DEPTHS) if first is None else _quantiles(r, light)
    weights, error = _weights(sources, scale, r, light, first is None)
    step(0.9, "Views")
    solved = solve(stack, quality)
    views = _views(solved, first, quality)
    through, in_volume, _ = _inside(solved, entry_lobes.COSINES, first, quality)
    share = _share(entry_lobes.mean(through), entry_lobes.mean(in_volume))
    entry = entry_lobes.fit(np.where(through.mean(axis=0) > LEAST_LIGHT, through, 0.0), share)
    entering = 0.0 if first is None else _entering(share.mean())
    step(1.0, "Done")
    return PortalTables(*sources, weights, scale, views, first, entering, entry, ior, roughness,
                        (beam.reflectance - on_top) / (1.0 - on_top), distance, error)


def _profile(beam: Searchlight, r: np.ndarray, first: FirstOrders | None) -> np.ndarray:
    """Flux density at `r` of the light through the portal, shape (r, channels)."""
    density = beam.profile(r).reshape(len(r), -1)
    if first is None:
        return np.maximum(density, 0.0)
    density = density - np.stack([first.density(r, c) for c in range(density.shape[1])], axis=1)
    # Near the entry nearly all light belongs to the first orders, and the errors of both may make the difference
    # negative. The flux within a distance becomes the mean of the least monotone function above and the largest below.
    flux = np.maximum(plane_rings.within(r, density), 0.0)
    above = np.maximum.accumulate(flux)
    below = np.minimum.accumulate(flux[::-1])[::-1]
    return np.diff(0.5 * (above + below), axis=0, prepend=0.0) / plane_rings.areas(r)[:, None]


def _quantiles(r: np.ndarray, light: np.ndarray) -> Sources:
    """Sources without absorption. Half of a Lambert source's light hits the plane within a distance equal to the
    source's depth, so the depths are quantiles of the exit distance."""
    flux, channels = plane_rings.within(r, light), light.shape[1]
    ranks = (np.arange(DEPTHS) + 0.5) / DEPTHS
    depths = np.interp(ranks, (flux / np.maximum(flux[-1], LEAST_FLUX)).mean(axis=1), r)
    return Sources(depths, np.ones((DEPTHS, channels)), np.zeros(channels))


def _lambert_density(depths: np.ndarray, r: np.ndarray) -> np.ndarray:
    """Mean density of hits on a plane at the distances `r`, rays from `depths` by Lambert's law, shape (len(r),)."""
    return np.mean(depths**2 / (math.pi * (r[:, None] ** 2 + depths**2) ** 2), axis=1)


def _weights(sources: Sources, scale: float, r: np.ndarray, light: np.ndarray,
             weighted_at_exit: bool) -> tuple[np.ndarray, float]:
    """(weights at WEIGHTS distances, largest error of the flux within any distance)."""
    flux = plane_rings.within(r, light)
    total = np.maximum(flux[-1], LEAST_FLUX)
    share = flux / total
    if weighted_at_exit:
        shown = np.stack([flux_density(sources.depths, r, k) @ of_depth / DEPTHS
                          for k, of_depth in zip(sources.decay, sources.shares.T, strict=True)], axis=1)
    else:
        shown = np.repeat(_lambert_density(sources.depths, r)[:, None], light.shape[1], axis=1)
    exact = light / total / np.maximum(shown, LEAST_FLUX)
    if np.any(sources.decay > 0.0):
        # The quotient is near 1, but for single scattering next to the entry, which grows like 1 / r, and for
        # distances that hardly any light reaches.
        exact = np.minimum(exact, LARGEST_WEIGHT)
    u, places = r / (r + scale), np.linspace(0.0, 1.0, WEIGHTS)
    table = np.stack([np.interp(places, u, column) for column in exact.T], axis=1)
    read = np.stack([np.interp(u, places, column) for column in table.T], axis=1)
    reached = plane_rings.within(r, read * shown)
    reached_in_all = np.maximum(reached[-1], LEAST_FLUX)
    return table / reached_in_all, float(np.max(np.abs(reached / reached_in_all - share)))


def _views(solved: ScatteringFunction, first: FirstOrders | None, quality: str) -> np.ndarray:
    """Share of the light entering below the boundary that goes through the portal, by view cosine."""
    cosines = np.linspace(0.0, 1.0, VIEWS)
    cosines[0] = 0.25 * cosines[1]
    inside, _, on_top = _inside(solved, cosines, first, quality)
    return np.clip(inside / np.maximum(1.0 - on_top, 1e-6), 0.0, 1.0)


def _share(part: np.ndarray, rest: np.ndarray) -> np.ndarray:
    """`part` of part + rest, 0 for no light."""
    return part / np.maximum(part + rest, LEAST_FLUX)


def _entering(share: float) -> float:
    """The share of the views that enter the volume, for the portal's `share` of the light. For light without other
    variance, the product of variance and time is least if views are in proportion to light over the root of cost."""
    volume = (1.0 - share) / math.sqrt(COST)
    return float(np.clip(volume / (volume + share), LEAST_ENTERING, MOST_ENTERING))


def _inside(solved: ScatteringFunction, cosines: np.ndarray, first: FirstOrders | None,
            quality: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(light through the portal, light of the first orders, light that a boundary on top reflects), as shares of the
    incident light, by view cosine or, by reciprocity, by incidence cosine."""
    on_top = boundary_on_top(solved.stack, cosines, quality)[0]
    inside = solved.reflectance(cosines) - on_top
    in_volume = np.zeros_like(inside) if first is None else first.reflectance(cosines)
    return np.maximum(inside - in_volume, 0.0), in_volume, on_top
