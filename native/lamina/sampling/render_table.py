# SPDX-License-Identifier: GPL-3.0-or-later
"""A scattering function as arrays that a renderer reads anywhere: values, mirror images, and a density for sampling.

Single scattering by the facets of rough boundaries is narrow. The table holds its ratio to the density of the facets'
normals, which is smooth, and apart from that everything else. Both are read by cubic polynomials in the two angles and
the azimuth."""

from __future__ import annotations

import math
import os
from dataclasses import astuple, dataclass, replace

import numpy as np

from .. import _core
from ..common.archive import Damaged, load_archive, save_archive
from ..common.arguments import check_choice
from ..common.errors import ExportError
from ..exchange.half_vectors import dilated, half_vector_grid, incident_angles
from ..kinds.boundaries import Interface
from ..solver.solve import ScatteringFunction, path_of, side_of
from .facet_densities import FacetDensity, summed

SIDES = ("top", "bottom")
PATHS = ("reflect", "transmit")
KNOTS = {"preview": (48, 24), "final": (96, 48)}  # of each angle from the normal to the horizon, and of |dphi|
LEAST_MU = 1e-6
FORMAT, SCHEMA = "lamina-render-table", 1
ARRAYS = ("smooth", "facets", "mirrored", "theta_views", "density", "chance")
VIEWS, HALF_VECTORS = 32, 64  # of the density for sampling: angles of views, and nodes in each of both axes
EVEN = 0.02  # share of the density that is even over the light's cosine, where the table may be wrong


@dataclass(frozen=True, eq=False)
class RenderTable:
    """Values for sights, pairs of the side of the view and the path of the light.

    `smooth` and `facets` have the shape (sights, thetas + 1, thetas + 1, azimuths + 2, channels): view, light, dphi.
    The first knot of each angle lies beyond the normal, the first and the last azimuth beyond 0 and pi. `smooth` is
    multiplied by the sum of both cosines; `facets` is divided by the density of facets' normals, `densities` by sight.
    `mirrored` (sights, thetas, channels): specular reflection, or unscattered light. `theta_views` (VIEWS): angles of
    views; `density` (sights, VIEWS, HALF_VECTORS, HALF_VECTORS): of half vectors, as in a .bsdf file, where transmitted
    light counts as its mirror image in the surface; `chance` (sights, VIEWS, 2): for a view the share of this sight's
    scattered and of its specular light in all light. `wavelengths`: of the channels in nm, or None for red, green and
    blue, or for grey."""

    sights: tuple[tuple[str, str], ...]
    smooth: np.ndarray
    facets: np.ndarray
    densities: tuple[tuple[FacetDensity, ...], ...]
    mirrored: np.ndarray
    theta_views: np.ndarray
    density: np.ndarray
    chance: np.ndarray
    name: str
    wavelengths: tuple[float, ...] | None

    @classmethod
    def of(cls, solved: ScatteringFunction, quality: str = "final") -> RenderTable:
        """The table of a solved stack. `quality` "preview" has half the knots on each axis, for an eighth of the time
        and some ten times the error. Raises StackError for anisotropic facets, and for a sheet that ends in another
        medium than air."""
        thetas, azimuths = KNOTS[check_choice(quality, "quality", KNOTS)]
        solved.stack.require_isotropic("a table for renderers")
        sheet = solved.stack.base is None
        if sheet:
            solved.stack.require_air_below()
        sights = tuple((side, path) for side in SIDES for path in PATHS) if sheet else (("top", "reflect"),)
        theta = np.linspace(0.0, 0.5 * math.pi, thetas)
        mu = np.maximum(np.cos(theta), LEAST_MU)
        dphi = math.pi * np.sin(0.5 * math.pi * np.linspace(0.0, 1.0, azimuths)) ** 2
        densities = tuple(_densities(solved, *sight) for sight in sights)
        smooth, facets = [], []
        for (side, path), own in zip(sights, densities, strict=True):
            values = solved.grid(path, mu, mu, dphi, entry(side, path))
            lobes = _lobes(solved, side, path, mu, dphi) if own else np.zeros_like(values)
            smooth.append(_padded((values - lobes) * (mu[:, None] + mu)[..., None, None]))
            around = _densities_on(own, theta, dphi)[..., None]
            facets.append(_padded(np.divide(lobes, around, out=np.zeros_like(lobes), where=around > 1e-30)))
        mirrored = np.stack([_fluxes(solved, *sight, mu)[1] for sight in sights])
        views, known = incident_angles(VIEWS), solved.stack.wavelengths
        table = cls(sights, np.array(smooth, np.float32), np.array(facets, np.float32), densities, mirrored, views,
                    np.empty(0), np.empty(0), solved.stack.label, None if known is None else tuple(known))
        return table._with_sampling(solved)

    def save(self, path: str | os.PathLike) -> None:
        """Writes the table as .npz, completely or not at all, without pickle. Raises OSError."""
        header = {"format": FORMAT, "schema": SCHEMA, "sights": self.sights, "name": self.name,
                  "wavelengths": self.wavelengths,
                  "densities": [[astuple(one) for one in own] for own in self.densities]}
        save_archive(path, header, **{name: getattr(self, name) for name in ARRAYS})

    @classmethod
    def load(cls, path: str | os.PathLike) -> RenderTable:
        """Reads a file that `save` wrote. Raises ExportError for a file that is truncated or foreign, or from a newer
        Lamina, and OSError when it cannot be opened."""
        try:
            header, arrays = load_archive(path, *ARRAYS)
            if not isinstance(header, dict) or header.get("format") != FORMAT:
                raise Damaged("its header names another format")
        except Damaged as error:
            raise ExportError(f"{path}: not a complete table for renderers: {error}") from None
        if header.get("schema") != SCHEMA:
            raise ExportError(f"{path}: schema {header.get('schema')} is not that of this Lamina, which is {SCHEMA}")
        sights = tuple((side, path) for side, path in header["sights"])
        densities = tuple(tuple(FacetDensity(*one) for one in own) for own in header["densities"])
        wavelengths = header["wavelengths"] and tuple(header["wavelengths"])
        return cls(sights=sights, densities=densities, name=header["name"], wavelengths=wavelengths,
                   **dict(zip(ARRAYS, arrays, strict=True)))

    @property
    def channels(self) -> int:
        return self.smooth.shape[-1]

    def values(self, sight: int, view, light) -> np.ndarray:
        """BRDF or BTDF in 1/sr, (n, channels), for unit directions (n, 3) that point away from the surface, where light
        on the other side of the surface has the opposite sign of z."""
        view, light = np.broadcast_arrays(view, light)
        mu_o, mu_i = np.abs(view[:, 2]), np.abs(light[:, 2])
        side_o, side_i = np.hypot(view[:, 0], view[:, 1]), np.hypot(light[:, 0], light[:, 1])
        dphi = np.abs(np.arctan2(light[:, 1] * view[:, 0] - light[:, 0] * view[:, 1],
                                 -light[:, 0] * view[:, 0] - light[:, 1] * view[:, 1]))
        places = [*(np.arctan2(side, mu) / (0.5 * math.pi) * (self.smooth.shape[1] - 2)
                    for side, mu in ((side_o, mu_o), (side_i, mu_i))),
                  np.arcsin(np.minimum(np.sqrt(dphi / math.pi), 1.0)) / (0.5 * math.pi) * (self.smooth.shape[3] - 3)]
        smooth, facets = (_read(one[sight], places) for one in (self.smooth, self.facets))
        across = ((view[:, :2] + light[:, :2]) ** 2).sum(axis=1)
        around = summed(self.densities[sight], side_o**2, side_i**2, across, np)
        return np.maximum(smooth / np.maximum(mu_o + mu_i, LEAST_MU)[:, None] + facets * around[:, None], 0.0)

    def _with_sampling(self, solved: ScatteringFunction) -> RenderTable:
        """The table with its density and chances, from its own values and from the solution's fluxes."""
        grid = half_vector_grid(HALF_VECTORS)
        density = np.empty((len(self.sights), VIEWS, HALF_VECTORS, HALF_VECTORS), np.float32)
        valid = np.empty(density.shape[1:], bool)
        for number in range(len(self.sights)):
            for k, angle in enumerate(self.theta_views):
                view = np.array([math.sin(angle), 0.0, math.cos(angle)])
                cosine, light, size = grid.lights(view)
                above = light[..., 2] > 0.0
                seen = np.where(above[..., None], light, light * [1.0, 1.0, -1.0]).reshape(-1, 3)
                values = self.values(number, view[None], seen).mean(axis=1).reshape(above.shape)
                contribution = values * np.abs(light[..., 2]) * size
                even = np.abs(light[..., 2]) * size
                contribution += EVEN * max(contribution.sum(), 1e-12) * even / even.sum()
                density[number, k] = contribution
                valid[k] = above & (cosine > 0.0)
            density[number] *= dilated(valid)  # nodes outside all cells with a valid direction need no samples
        mu = np.cos(self.theta_views)
        fluxes = np.array([[one.mean(axis=-1) for one in _fluxes(solved, *sight, mu)] for sight in self.sights])
        chance = np.moveaxis(fluxes, 1, 2)
        for side in SIDES:
            own = [number for number, sight in enumerate(self.sights) if sight[0] == side]
            if own:
                chance[own] /= np.maximum(chance[own].sum(axis=(0, 2)), 1e-12)[None, :, None]
        return replace(self, density=density, chance=chance)


def entry(side: str, path: str) -> str:
    """The side where light enters that a view on `side` sees."""
    return side if path == "reflect" else SIDES[1 - SIDES.index(side)]


def _fluxes(solved: ScatteringFunction, side: str, path: str, mu) -> tuple[np.ndarray, np.ndarray]:
    """(scattered, specular) light of uniform surroundings towards views on `side`, by reciprocity the fluxes of
    beams."""
    call = solved.reflectance if path == "reflect" else solved.transmittance
    return call(mu, side, True)


def _lobes(solved: ScatteringFunction, side: str, path: str, mu, dphi) -> np.ndarray:
    """Single scattering by facets in 1/sr, [view, light, dphi, channel]."""
    distinct = list({id(one): one for one in solved.solutions}.values())
    found = _core.slices(distinct, [(side_of(side), path_of(path))], mu, mu, dphi, solved.pool)[1]
    if found is None:
        return np.zeros((len(mu), len(mu), len(dphi), len(solved.solutions)))
    place = {id(one): k for k, one in enumerate(distinct)}
    lobes = found[0].reshape(len(distinct), len(mu), len(mu), len(dphi)) / mu[:, None]
    return np.moveaxis(lobes[[place[id(one)] for one in solved.solutions]], 0, -1)


def _densities(solved: ScatteringFunction, side: str, path: str) -> tuple[FacetDensity, ...]:
    """The rough boundaries whose facets a view sees, by their first channel."""
    found, above = [], 1.0
    for layer in solved.stack.layers:
        if isinstance(layer, Interface):
            below = _first(layer.ior)
            if _first(layer.alpha) > 0.0 and (path == "reflect" or above != below):
                near, far = (above, below) if side == "top" else (below, above)
                found.append(FacetDensity(_first(layer.alpha), layer.distribution == "ggx", near,
                                          near if path == "reflect" else -far))
            above = below
    base = solved.stack.base
    alpha = _first(getattr(base, "alpha", 0.0))
    if alpha > 0.0:
        found.append(FacetDensity(alpha, getattr(base, "distribution", "ggx") == "ggx", above, above))
    return tuple(found)


def _first(value) -> float:
    return float(np.ravel(value)[0])


def _densities_on(own, theta, dphi) -> np.ndarray:
    sine = np.sin(theta)
    across = (sine[:, None, None] - sine[:, None]) ** 2 + 4.0 * sine[:, None, None] * sine[:, None] * np.sin(
        0.5 * dphi) ** 2
    return summed(own, (sine**2)[:, None, None], (sine**2)[:, None], across, np)


def _padded(values: np.ndarray) -> np.ndarray:
    """With knots beyond the normal, where the azimuth is turned, and beyond both ends of the azimuth."""
    for axis in (0, 1):
        beyond = np.flip(np.take(values, [1], axis), axis=2)
        values = np.concatenate([beyond, values], axis)
    return np.concatenate([values[:, :, 1:2], values, values[:, :, -2:-1]], axis=2)


def _read(table: np.ndarray, places) -> np.ndarray:
    """`table` [view, light, dphi, channel] at fractional indices of the knots before padding."""
    firsts, weights = zip(*(stencil(place, size, np) for place, size in zip(places, table.shape, strict=False)),
                          strict=True)
    total = np.zeros((len(places[0]), table.shape[-1]))
    for a in range(4):
        for b in range(4):
            for c in range(4):
                own = weights[0][a] * weights[1][b] * weights[2][c]
                total += own[:, None] * table[firsts[0] + a, firsts[1] + b, firsts[2] + c]
    return total


def stencil(place, size: int, xp):
    """(first knot, Lagrange's weights of four) at a place that counts from the knot after the first of `size`."""
    first = np.clip(np.floor(place).astype(int), 0, size - 4)
    return first, lagrange(place + 1.0 - first)


def lagrange(s):
    """The weights of the knots 0, 1, 2, 3 at s."""
    a, b, c = s - 1.0, s - 2.0, s - 3.0
    return a * b * c * (-1.0 / 6.0), s * b * c * 0.5, s * a * c * -0.5, s * a * b * (1.0 / 6.0)
