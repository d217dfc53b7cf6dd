# SPDX-License-Identifier: GPL-3.0-or-later
"""The knots of a table for renderers, and a solution's values there."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .. import _core
from ..common.progress import Progress
from ..kinds.boundaries import Interface
from ..material.stack import Stack
from ..solver.core_calls import path_of, side_of
from ..solver.solve import ScatteringFunction
from .facet_densities import FacetDensity, summed

SIDES = ("top", "bottom")
PATHS = ("reflect", "transmit")
LEAST_MU = 1e-6
PARTS = 8  # of the views, between which progress is told, where facets scatter light twice: that takes minutes


def entry(side: str, path: str) -> str:
    """The side where light enters that a view on `side` sees."""
    return side if path == "reflect" else SIDES[1 - SIDES.index(side)]


def fluxes(solved: ScatteringFunction, side: str, path: str, mu) -> tuple[np.ndarray, np.ndarray]:
    """(scattered, specular) light of uniform surroundings towards views on `side`, by reciprocity the fluxes of
    beams."""
    call = solved.reflectance if path == "reflect" else solved.transmittance
    return call(mu, side, True)


@dataclass(frozen=True, eq=False)
class Knots:
    """`theta`, and its cosines `mu`: angles of both directions, even from the normal to the horizon. `dphi`: azimuths
    from 0 to pi, denser at both ends."""

    theta: np.ndarray
    mu: np.ndarray
    dphi: np.ndarray

    @classmethod
    def even(cls, thetas: int, azimuths: int) -> Knots:
        theta = np.linspace(0.0, 0.5 * math.pi, thetas)
        dphi = math.pi * np.sin(0.5 * math.pi * np.linspace(0.0, 1.0, azimuths)) ** 2
        return cls(theta, np.maximum(np.cos(theta), LEAST_MU), dphi)

    def arrays(self, solved: ScatteringFunction, side: str, path: str,
               densities: tuple[FacetDensity, ...], step: Progress) -> tuple[np.ndarray, np.ndarray]:
        """`smooth` and `facets` of a RenderTable for one sight, [view, light, dphi, channel]."""
        parts = np.array_split(self.mu, PARTS if densities and _may_meet(solved.stack) else 1)
        rows = []
        for number, part in enumerate(parts):
            step(number / len(parts), f"Tabulating {side}, {path}")
            rows.append(solved.grid(path, part, self.mu, self.dphi, entry(side, path)))
        values = np.concatenate(rows)
        lobes = self._lobes(solved, side, path) if densities else np.zeros_like(values)
        around = self._around(densities)[..., None]
        ratio = np.divide(lobes, around, out=np.zeros_like(lobes), where=around > 1e-30)
        return _padded((values - lobes) * (self.mu[:, None] + self.mu)[..., None, None]), _padded(ratio)

    def _lobes(self, solved: ScatteringFunction, side: str, path: str) -> np.ndarray:
        """Single scattering by facets in 1/sr."""
        distinct = list({id(one): one for one in solved.solutions}.values())
        found = _core.slices(distinct, [(side_of(side), path_of(path))], self.mu, self.mu, self.dphi, solved.pool)[1]
        shape = len(self.mu), len(self.mu), len(self.dphi)
        if found is None:
            return np.zeros((*shape, len(solved.solutions)))
        place = {id(one): k for k, one in enumerate(distinct)}
        lobes = found[0].reshape(len(distinct), *shape) / self.mu[:, None]
        return np.moveaxis(lobes[[place[id(one)] for one in solved.solutions]], 0, -1)

    def _around(self, densities: tuple[FacetDensity, ...]) -> np.ndarray:
        """The summed density of facets' normals."""
        view, light = np.sin(self.theta)[:, None, None], np.sin(self.theta)[:, None]
        across = (view - light) ** 2 + 4.0 * view * light * np.sin(0.5 * self.dphi) ** 2
        return summed(densities, view**2, light**2, across, np)


def _may_meet(stack: Stack) -> bool:
    """True if light may go from one boundary to another."""
    return sum(isinstance(layer, Interface) for layer in stack.layers) + hasattr(stack.base, "alpha") > 1


def _padded(values: np.ndarray) -> np.ndarray:
    """With knots beyond the normal, where the azimuth is turned, and beyond both ends of the azimuth."""
    for axis in (0, 1):
        beyond = np.flip(np.take(values, [1], axis), axis=2)
        values = np.concatenate([beyond, values], axis)
    return np.concatenate([values[:, :, 1:2], values, values[:, :, -2:-1]], axis=2)
