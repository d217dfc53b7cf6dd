# SPDX-License-Identifier: GPL-3.0-or-later
"""A scattering function as arrays that a renderer reads anywhere: values, mirror images, and a density for sampling.

Single scattering by the facets of rough boundaries is narrow. The table holds its ratio to the density of the facets'
normals, which is smooth, and apart from that everything else. Both are read by cubic polynomials in the two angles and
the azimuth."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import astuple, dataclass, replace

import numpy as np

from ..common.archive import Damaged, load_archive, save_archive
from ..common.arguments import check_choice, check_kind
from ..common.errors import ExportError
from ..common.progress import Progress, portion, stepper
from ..exchange.half_vectors import incident_angles
from ..kinds.table import TAU_BEND
from ..solver.solve import ScatteringFunction
from .facet_densities import FacetDensity, densities_of, summed
from .render_knots import LEAST_MU, PATHS, SIDES, Knots, fluxes
from .render_sampling import VIEWS, sampling_of

# Of each angle from the normal to the horizon, of |dphi|, and of the thickness of a varying layer.
KNOTS = {"preview": (48, 24, 9), "final": (96, 48, 17)}
FORMAT, SCHEMA = "lamina-render-table", 1
TRANSMITTED = ("top", "transmit")
ARRAYS = ("smooth", "facets", "mirrored", "theta_views", "density", "chance")


@dataclass(frozen=True, eq=False)
class RenderTable:
    """Values for sights, pairs of the side of the view and the path of the light.

    `smooth` and `facets` have the shape (sights, rows, thetas + 1, thetas + 1, azimuths + 2, channels): thickness,
    view, light, dphi. The first knot of each angle lies beyond the normal, the first and the last azimuth beyond 0 and
    pi. `smooth` is multiplied by the sum of both cosines; `facets` is divided by the density of facets' normals,
    `densities` by sight, and is empty without them. `largest` is the thickness of the last row, 0 where nothing varies;
    rows are even in tau / (tau + TAU_BEND). `mirrored` (sights, rows, thetas, channels): specular reflection, or
    unscattered light. `theta_views` (VIEWS): angles of views; `density` (sights, rows, VIEWS, HALF_VECTORS,
    HALF_VECTORS): of half vectors, as in a .bsdf file, where transmitted light counts as its mirror image in the
    surface; `chance` (sights, rows, VIEWS, 2): for a view the share of this sight's scattered and of its specular light
    in all light. `wavelengths`: of the channels in nm, or None for red, green and blue, or for grey."""

    sights: tuple[tuple[str, str], ...]
    smooth: np.ndarray
    facets: np.ndarray
    densities: tuple[tuple[FacetDensity, ...], ...]
    mirrored: np.ndarray
    theta_views: np.ndarray
    density: np.ndarray
    chance: np.ndarray
    largest: float
    name: str
    wavelengths: tuple[float, ...] | None

    @classmethod
    def of(cls, solved: ScatteringFunction, quality: str = "final", progress: Progress | None = None,
           cancel: Callable[[], bool] | None = None) -> RenderTable:
        """The table of a solved stack, by thickness if one of its media is varying. `quality` "preview" has half the
        knots on each axis, for an eighth of the time and some ten times the error. `progress(fraction, text)` is called
        often; Cancelled is raised when `cancel()` returns true. Raises ArgumentError, and StackError for anisotropic
        facets and for a sheet that ends in another medium than air."""
        check_kind(solved, "solved", ScatteringFunction, "what lamina.solve returned")
        step = stepper("the table for renderers", progress, cancel)
        thetas, azimuths, rows = KNOTS[check_choice(quality, "quality", KNOTS)]
        stack = solved.stack
        stack.require_isotropic("a table for renderers")
        sheet, varying = stack.base is None, stack.varying
        if sheet:
            stack.require_air_below()
        sights = tuple((side, path) for side in SIDES for path in PATHS) if sheet else (("top", "reflect"),)
        taus = [] if varying is None else [stack.optics(varying, index)[1] for index in range(stack.channels)]
        functions, largest = [solved], max(taus, default=0.0)
        if varying is not None and largest > 0.0:
            functions = [solved.with_thickness(varying, [tau * share for tau in taus])
                         for share in thickness_shares(largest, rows)]
        grid = Knots.even(thetas, azimuths)
        densities = tuple(densities_of(solved.stack, *sight) for sight in sights)
        known = stack.wavelengths
        found: list = []
        for number, (sight, own) in enumerate(zip(sights, densities, strict=True)):
            if sight == ("bottom", "transmit"):  # by reciprocity
                found.append([tuple(part.swapaxes(0, 1) for part in row) for row in found[sights.index(TRANSMITTED)]])
                continue
            part = portion(step, number / len(sights), (number + 1) / len(sights))
            found.append([grid.arrays(one, *sight, own, portion(part, k / len(functions), (k + 1) / len(functions)))
                          for k, one in enumerate(functions)])
        smooth, facets = (np.array([[one[k] for one in row] for row in found], np.float32) for k in (0, 1))
        mirrored = np.array([[fluxes(one, *sight, grid.mu)[1] for one in functions] for sight in sights])
        table = cls(sights, smooth, facets if any(densities) else facets[..., :0], densities, mirrored,
                    incident_angles(VIEWS), np.empty(0), np.empty(0), largest, stack.label,
                    None if known is None else tuple(known))
        density, chance = sampling_of(table, functions)
        step(1.0, "Tabulated")
        return replace(table, density=density, chance=chance)

    def save(self, path: str | os.PathLike) -> None:
        """Writes the table as .npz, completely or not at all, without pickle. Raises OSError."""
        header = {"format": FORMAT, "schema": SCHEMA, "sights": self.sights, "name": self.name,
                  "largest": self.largest, "wavelengths": self.wavelengths,
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
        try:
            known = header["wavelengths"]
            table = cls(sights=tuple((side, path) for side, path in header["sights"]),
                        densities=tuple(tuple(FacetDensity(*one) for one in own) for own in header["densities"]),
                        largest=float(header["largest"]), name=str(header["name"]),
                        wavelengths=None if known is None else tuple(map(float, known)),
                        **dict(zip(ARRAYS, arrays, strict=True)))
        except (KeyError, TypeError, ValueError):
            raise ExportError(f"{path}: not a complete table for renderers: its header is damaged") from None
        if not table._holds_together:
            raise ExportError(f"{path}: not a complete table for renderers: its header and its arrays do not fit "
                              "together")
        return table

    @property
    def _holds_together(self) -> bool:
        """True if the shapes are those of the description, and all numbers finite."""
        arrays = [getattr(self, name) for name in ARRAYS]
        if self.smooth.ndim != 6 or not all(one.dtype.kind == "f" and np.all(np.isfinite(one)) for one in arrays):
            return False
        *lists, channels = self.smooth.shape
        first, views = (len(self.sights), self.rows), self.theta_views.size
        return (len(self.densities) == len(self.sights) in (1, 4) and min(self.smooth.shape) > 0
                and (self.largest > 0.0) == (self.rows > 1)
                and (self.wavelengths is None or len(self.wavelengths) == channels)
                and self.facets.shape == (*lists, channels if any(self.densities) else 0)
                and self.smooth.shape[:2] == first and self.mirrored.shape == (*first, lists[2] - 1, channels)
                and self.theta_views.shape == (views,) and self.chance.shape == (*first, views, 2)
                and self.density.shape[:3] == (*first, views) and self.density.ndim == 5)

    @property
    def channels(self) -> int:
        return self.smooth.shape[-1]

    @property
    def rows(self) -> int:
        """The number of thicknesses."""
        return self.smooth.shape[1]

    @property
    def row_taus(self) -> list[float]:
        """The thicknesses of the rows."""
        return (self.largest * thickness_shares(self.largest, self.rows)).tolist()

    def row_of(self, tau, xp=np):
        """The row, between 0 and `rows` - 1, of a thickness `tau`; `xp`: the module of maximum and minimum."""
        tau = xp.minimum(xp.maximum(tau, 0.0), self.largest)
        return tau / (tau + TAU_BEND) * ((self.rows - 1) * (1.0 + TAU_BEND / self.largest))

    def values(self, sight: int, view, light, tau: float | None = None) -> np.ndarray:
        """BRDF or BTDF in 1/sr, (n, channels), for unit directions (n, 3) that point away from the surface, where light
        on the other side of the surface has the opposite sign of z; `tau`: the thickness of the varying layer in its
        thickest channel, by default the largest."""
        view, light = np.broadcast_arrays(view, light)
        mu_o, mu_i = np.abs(view[:, 2]), np.abs(light[:, 2])
        side_o, side_i = np.hypot(view[:, 0], view[:, 1]), np.hypot(light[:, 0], light[:, 1])
        dphi = np.abs(np.arctan2(light[:, 1] * view[:, 0] - light[:, 0] * view[:, 1],
                                 -light[:, 0] * view[:, 0] - light[:, 1] * view[:, 1]))
        turns = self.smooth.shape[4]
        per_angle = (self.smooth.shape[2] - 2) / (0.5 * math.pi)
        places = [np.arctan2(side_o, mu_o) * per_angle, np.arctan2(side_i, mu_i) * per_angle,
                  np.arcsin(np.minimum(np.sqrt(dphi / math.pi), 1.0)) / (0.5 * math.pi) * (turns - 3)]
        first, weights = 0, (1.0,)
        if self.rows > 1:
            place = round(self.row_of(self.largest if tau is None else tau), 9)
            first = int(np.clip(math.floor(place) - 1, 0, self.rows - 4))
            weights = lagrange(place - first)
        rows = [(first + k, own) for k, own in enumerate(weights) if own != 0.0]
        value = sum(own * _read(self.smooth[sight, row], places) for row, own in rows)
        value /= np.maximum(mu_o + mu_i, LEAST_MU)[:, None]
        if self.densities[sight]:
            across = ((view[:, :2] + light[:, :2]) ** 2).sum(axis=1)
            around = summed(self.densities[sight], side_o**2, side_i**2, across, np)[:, None]
            value += around * sum(own * _read(self.facets[sight, row], places) for row, own in rows)
        return np.maximum(value, 0.0)


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


def thickness_shares(largest: float, rows: int) -> np.ndarray:
    """Thicknesses of the rows as shares of the largest."""
    t = np.linspace(0.0, 1.0, rows) / (1.0 + TAU_BEND / largest)
    shares = TAU_BEND * t / (1.0 - t) / largest
    shares[-1] = 1.0
    return shares
