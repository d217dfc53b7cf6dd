# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables for a tabulated BSSRDF of a stack, rendered in Cycles by its Ray Portal BSDF.

The portal moves the camera ray to a source below the shading point, with a random direction. The ray hits the surface
from inside and evaluates ordinary closures there. Weights turn the density of hits into the stack's profile.

The profile is a mixture of sources at the depths z in a diffusing medium with the decay k (source_depths). On the way t
to a surface with the curvature 1 / a, at the height h over the tangent plane of the exit, a source sends the density
    (u + k t sqrt(u h)) exp(-k (t - z)) / (2 pi t^3),  u = z (1 - s)^p,  s = z / 2 a.
With p = 1 and without absorption, this is Poisson's formula for a sphere. On a plane, where u = h = z, it is the flux
below a plane that absorbs. In between, sqrt(u h) follows the series for a sphere within some 10 %, where u alone is too
small, and h alone, the limit for much absorption, is too large. Rays that are uniform in a hemisphere hit the surface
with the density h / (2 pi t^3).

To first order, the light of a sphere exceeds that of a plane by the mean depth of the light over the radius. Sources
are deeper than the light: p is 3 - 2 d / z for the mean depths d of the light and z of the sources. At strong curvature
rays below the horizon are missing, which is made up for by a smaller p: three quarters of what it exceeds 1 by. Where
no first orders of scattering tell d, as below a boundary, p is 0, which errs less than 1 without these rays."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..common.by_content import ByContent
from ..common.errors import StackError
from ..common.progress import Progress, portion, stepper
from ..lateral.searchlight import Searchlight, searchlight
from ..material.any_stack import AnyStack, as_stack
from ..material.millimetres import require_millimetres
from ..solver.solve import ScatteringFunction, solve
from . import entry_lobes, exit_tilt, first_orders, plane_rings, portal_views, source_depths
from .depth_colours import in_colours
from .entry_lobes import EntryLobes
from .first_orders import FirstOrders
from .node_parameters import LEAST_IOR
from .plane_rings import LEAST_FLUX
from .source_depths import Sources, flux_density
from .stack_nodes import boundary_on_top, require_finite_distance, require_hidden_metal

DEPTHS, VIEWS = 512, 64  # sizes of the tables
NODES, EXIT_COSINES = 8192, 32  # of integrals over a plane and over directions

# The cosine c between a source's ray and the normal has a density in proportion to c + LIFT, from 0 to 1. Rays below
# the horizon would carry light through curved bodies, but open meshes would show the background to these rays.
LIFT = 0.4
LEAST_LIGHT = 1e-4  # through the portal: less, as in a dark channel after the first orders, has no exact direction
LEAST_ENTERING, MOST_ENTERING = 0.1, 0.85  # limits of the share of the views that enter the volume
COST = 1.6  # time of a path in the volume, in paths through the portal


@dataclass(frozen=True, eq=False)
class PortalTables(ByContent):
    """Tables of the portal. Lengths in millimetres.

    `depths`, shape (DEPTHS,): equally likely depths z of sources. `decay`, (channels,): decay k of the light along a
    ray, 1/mm, 0 for none. `views`, (VIEWS, channels): share of the light entering below the boundary that goes through
    the portal, at the view cosine i / (VIEWS - 1). `shares`, (VIEWS, DEPTHS, channels): weight of a ray by view and by
    the depth of its source, with a mean of 1 over depths. `curved`: the exponent p for curved surfaces. `first`: the
    orders of scattering that do not go through the portal, or None. `entering`: share of the views that enter the
    volume for these orders; the others take the portal. `entry`: closures for the directions from which light enters.
    `tilt`: the Diffuse closure leans along the ray, by the tangent `tilt` times the sine of the ray's angle. `ior`,
    `roughness`: the boundary on top, ior 1.01 for none. `albedo`, `distance`, (channels,): exit albedo and mean exit
    distance of all light without the boundary's reflection, for a view along the normal. `profile_error`: largest error
    of the flux within any distance on a plane, relative to the total flux."""

    depths: np.ndarray
    decay: np.ndarray
    views: np.ndarray
    shares: np.ndarray
    curved: float
    first: FirstOrders | None
    entering: float
    entry: EntryLobes
    tilt: float
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
    def lift(self) -> float:
        """The cosine c between a source's ray and the normal has a density in proportion to c + lift, from 0 to 1."""
        return LIFT

    @property
    def report(self) -> str:
        """The predicted result of the tables and its error, in one or two sentences."""
        ways = ", ".join(f"{way:.3g}" for way in self.distance)
        flat = (f"Portal: on a flat surface the tables keep the flux within any distance to "
                f"{max(100.0 * self.profile_error, 0.01):.2g} %, mean exit distance {ways} mm.")
        if self.first is None:
            return flat
        times = "once" if self.first.count == 1 else f"up to {self.first.count} times"
        return f"{flat} Light is scattered {times} in the volume, the rest takes the portal."


def portal_tables(stack: AnyStack, quality: str = "final", progress: Progress | None = None,
                  cancel: Callable[[], bool] | None = None, scatterings: int | None = None) -> PortalTables:
    """Tables with which Cycles' Ray Portal BSDF renders the lateral light transport of a stack.

    If the topmost layer is a deep medium without a boundary, with isotropic scattering or Henyey and Greenstein's phase
    function, the portal leaves out the first orders of scattering, which Cycles' volume rendering adds. `scatterings`:
    their number, 1 to 14; by default 1 for isotropic scattering, and more for forward scattering. Fewer render in less
    time and with less noise, and show less of the sun's direction on curved bodies. Beyond an anisotropy of .9 there is
    always one. A stack with wavelengths must be one medium, below at most one interface, which becomes a medium of
    three channels. Other arguments and errors are those of lamina.subsurface_nodes."""
    stack = as_stack(stack)
    stack.require_isotropic("a portal")
    stack.require_no_flakes("a portal")
    require_hidden_metal(stack)
    require_millimetres(stack)
    stack = in_colours(stack)
    first = first_orders.of_stack(stack, scatterings)
    step = stepper("the portal", progress, cancel)
    beam = searchlight(stack, 1.0, quality, progress=portion(step, 0.0, 0.8), cancel=cancel)
    on_top, ior, roughness = boundary_on_top(stack, 1.0, quality)
    distance = require_finite_distance(beam, on_top)
    if not np.median(distance) > 0.0:
        raise StackError("the stack: no light travels sideways, must have a medium that scatters")
    r = plane_rings.distances(float(np.median(distance)), NODES)
    light = _profile(beam, r, first)
    sources = source_depths.fit(r, light, DEPTHS)
    step(0.9, "Views")
    solved = solve(stack, quality)
    cosines = np.linspace(0.0, 1.0, VIEWS)
    cosines[0] = 0.25 * cosines[1]
    shares, curved = portal_views.shares_and_curved(first, sources, cosines)
    through, in_volume, _ = _inside(solved, entry_lobes.COSINES, first, quality)
    share = _share(entry_lobes.mean(through), entry_lobes.mean(in_volume))
    leaving, weights = source_depths.exit_cosines(sources, EXIT_COSINES)
    sines = np.sqrt(1.0 - leaving**2)
    tilt = 0.0 if first is None else exit_tilt.of_orders(first) / float(np.mean(sines @ weights))
    entry = entry_lobes.fit(np.where(through.mean(axis=0) > LEAST_LIGHT, through, 0.0), share, tilt * sines, weights)
    entering = 0.0 if first is None else _entering(share.mean())
    step(1.0, "Done")
    below = beam.reflectance - on_top
    error = _profile_error(sources, r, light, below)
    views = _views(solved, cosines, first, quality)
    return PortalTables(sources.depths, sources.decay, views, shares, curved, first, entering, entry, tilt, ior,
                        roughness, below / (1.0 - on_top), distance, error)


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


def _profile_error(sources: Sources, r: np.ndarray, light: np.ndarray, total: np.ndarray) -> float:
    """Largest error of the flux within any distance, relative to the flux `total`, (channels,)."""
    shown = np.stack([flux_density(sources.depths, r, k) @ of_depth / DEPTHS
                      for k, of_depth in zip(sources.decay, sources.shares.T, strict=True)], axis=1)
    flux = plane_rings.within(r, light)
    apart = np.abs(plane_rings.within(r, shown) * flux[-1] - flux)
    return float(np.max(apart / np.maximum(total, LEAST_FLUX)))


def _views(solved: ScatteringFunction, cosines: np.ndarray, first: FirstOrders | None, quality: str) -> np.ndarray:
    """Share of the light entering below the boundary that goes through the portal, by view cosine."""
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
