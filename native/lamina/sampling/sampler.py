# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluates a scattering function, and draws directions of light for views, for renderers in Python."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from ..baking.table.lut import Lut
from ..common.arguments import check_choice, finite_array
from ..common.errors import ArgumentError, StackError, quoted
from ..solver.solve import ScatteringFunction
from .direction_cells import DirectionCells

VIEWS = 32  # columns of cells, evenly spaced in angle
LEAST_MU = 0.01
EVEN = 0.05  # share of directions that are drawn by the cosine, where the cells may be wrong
SIDES = ("top", "bottom")
UNIT = 1e-3  # largest error of the length of a direction


@dataclass(frozen=True, eq=False)
class DrawnLight:
    """Directions drawn for n views. `light`: unit directions to the light, (n, 3). `weight`: the function times the
    cosine of the light over the probability, (n, channels); the mean of weights times radiances is the radiance
    towards the view. `pdf`: per solid angle, (n,); of mirror images and of unscattered light the probability itself,
    where `is_delta`, (n,) bool, is true."""

    light: np.ndarray
    weight: np.ndarray
    pdf: np.ndarray
    is_delta: np.ndarray


class Sampler:
    """Evaluation and importance sampling of a scattering function in a frame whose +z is the normal on `side`.

    `function`: a lamina.ScatteringFunction, whose values are exact, or a lamina.Lut, whose values are those that Cycles
    renders; `tau`: the thickness of a table's varying layer, by default the largest. Directions are unit vectors,
    (n, 3), and point away from the surface; views have z > 0, light with z < 0 is transmitted. Directions are drawn
    from cells that hold the function at 32 views, which takes less than a second, or up to some ten seconds for narrow
    lobes under smooth boundaries. Raises ArgumentError, and StackError for a stack with anisotropic facets and for
    the bottom of a stack that is no sheet in air."""

    def __init__(self, function: ScatteringFunction | Lut, side: str = "top", tau: float | None = None):
        if not isinstance(function, ScatteringFunction | Lut):
            what = type(function).__name__
            raise ArgumentError(f"function = {what}: must be a lamina.ScatteringFunction or a lamina.Lut")
        if tau is not None and not isinstance(function, Lut):
            raise ArgumentError("tau is the thickness in a table: leave it out, or use with_thickness")
        check_choice(side, "side", SIDES)
        function.stack.require_isotropic("a sampler")
        self._function, self._side, self._more = function, side, {"tau": tau} if isinstance(function, Lut) else {}
        is_sheet = function.stack.base is None
        if side == "bottom" and not is_sheet:
            raise StackError("base: a sampler of the bottom needs a sheet, which has none")
        self._paths = ("reflect", "transmit") if is_sheet else ("reflect",)
        self._channels = 3 if isinstance(function, Lut) else function.stack.channels
        self._cells = [DirectionCells.about(mu, functools.partial(self._contributions, mu)) for mu in
                       np.maximum(np.cos(np.linspace(0.0, 0.5 * np.pi, VIEWS)), LEAST_MU)]

    def evaluate(self, view, light) -> np.ndarray:
        """The function times the cosine of the light, (n, channels), in 1/sr; 0 for light below an opaque stack. Deltas
        do not count."""
        view, light = self._directions(view, light)
        mu_o, mu_i, dphi, path = self._angles(view, light)
        return self._values(mu_o, mu_i, dphi, path) * mu_i[:, None]

    def pdf(self, view, light) -> np.ndarray:
        """The probability per solid angle, (n,), with which `sample` draws a direction that is no delta."""
        view, light = self._directions(view, light)
        mu_o, mu_i, dphi, path = self._angles(view, light)
        return (1.0 - self._deltas(mu_o)[1].sum(axis=0)) * self._density(mu_o, mu_i, dphi, path)

    def sample(self, view, u) -> DrawnLight:
        """DrawnLight for views and uniform random numbers `u`, (n, 4) in [0, 1)."""
        u = finite_array(u, "u")
        if u.ndim != 2 or u.shape[1] != 4 or u.min(initial=0.0) < 0.0 or u.max(initial=0.0) >= 1.0:
            raise ArgumentError(f"u = {quoted(u)}: must be (n, 4) numbers in [0, 1)")
        view = np.broadcast_to(self._unit(view, "view"), (len(u), 3))
        light, weight = np.empty((len(u), 3)), np.empty((len(u), self._channels))
        pdf, is_delta, from_start = np.empty(len(u)), np.zeros(len(u), bool), np.zeros(len(u))
        light_of_deltas, chance = self._deltas(view[:, 2])
        for number, name in enumerate(self._paths):
            taken = (u[:, 0] >= from_start) & (u[:, 0] < from_start + chance[number])
            from_start = from_start + chance[number]
            light[taken] = view[taken] * [-1.0, -1.0, 1.0 if name == "reflect" else -1.0]
            pdf[taken] = chance[number][taken]
            weight[taken] = light_of_deltas[number][taken] / chance[number][taken, None]
            is_delta |= taken
        others = ~is_delta
        left = 1.0 - from_start[others]
        # What is left of the number that has decided against the deltas is again even in [0, 1).
        rest = np.clip((u[others, 0] - from_start[others]) / np.maximum(left, 1e-12), 0.0, 1.0 - 1e-12)
        drawn = self._drawn(view[others, 2], np.column_stack([rest, u[others, 1:]]))
        light[others] = _light(view[others], *drawn)
        pdf[others] = left * self._density(view[others, 2], *drawn)
        weight[others] = self._values(view[others, 2], *drawn) * (drawn[0] / pdf[others])[:, None]
        return DrawnLight(light, weight, pdf, is_delta)

    def _contributions(self, mu_o: float, mu_i, dphi) -> list[np.ndarray]:
        """Mean over the channels of the function times the cosine, by path; even light is mixed in."""
        found = []
        for name in self._paths:
            if isinstance(self._function, Lut):
                values = self._function.evaluate(mu_o, mu_i, dphi, name, self._entry(name), **self._more)
            else:
                values = self._function.grid(name, [mu_o], mu_i.ravel(), dphi.ravel(), self._entry(name))[0]
            found.append(values.mean(axis=-1) * mu_i)
        sizes = [float(one.sum()) for one in found]
        even = np.broadcast_to(mu_i, found[0].shape)
        total = max(sum(sizes), 1e-30)
        return [one + EVEN * total * even / (len(found) * even.sum()) for one in found]

    def _entry(self, path: str) -> str:
        """The side where light enters."""
        return self._side if path == "reflect" else SIDES[1 - SIDES.index(self._side)]

    def _values(self, mu_o, mu_i, dphi, path) -> np.ndarray:
        found = np.zeros((len(mu_o), self._channels))
        for number, name in enumerate(self._paths):
            here = (path == number) & (mu_i > 0.0)
            if not here.any():
                continue
            angles = mu_o[here], mu_i[here], dphi[here]
            if isinstance(self._function, Lut):
                found[here] = self._function.evaluate(*angles, name, self._entry(name), **self._more)
            else:
                call = self._function.brdf if name == "reflect" else self._function.btdf
                found[here] = call(*angles, self._entry(name))
        return found

    def _deltas(self, mu_o) -> tuple[np.ndarray, np.ndarray]:
        """(the light of deltas [path, view, channel], the chance to draw them [path, view])."""
        mu, back = np.unique(mu_o, return_inverse=True)  # often one view for many directions
        parts = [self._function.reflectance(mu, self._side, True, **self._more)]
        if len(self._paths) == 2:
            parts.append(self._function.transmittance(mu, self._side, True, **self._more))
        deltas = np.stack([direct for _, direct in parts])
        total = sum(spread + direct for spread, direct in parts).mean(axis=-1)
        return deltas[:, back], (deltas.mean(axis=-1) / np.maximum(total, 1e-30))[:, back]

    def _density(self, mu_o, mu_i, dphi, path) -> np.ndarray:
        """The density of directions that are no deltas, a mixture of that of both neighbouring views."""
        lower, share = self._neighbours(mu_o)
        found = np.zeros(len(mu_o))
        seen = mu_i > 0.0
        for number in np.unique(lower[seen]):
            here = seen & (lower == number)
            for step, part in ((0, 1.0 - share[here]), (1, share[here])):
                cells = self._cells[min(number + step, VIEWS - 1)]
                found[here] += part * cells.density(path[here], mu_i[here], dphi[here])
        return found

    def _drawn(self, mu_o, u) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(mu_i, dphi, path) of directions that are no deltas."""
        lower, share = self._neighbours(mu_o)
        column = np.minimum(lower + (u[:, 3] < share), VIEWS - 1)
        path, mu_i, dphi = np.zeros(len(u), int), np.zeros(len(u)), np.zeros(len(u))
        for number in np.unique(column):
            here = column == number
            path[here], mu_i[here], dphi[here] = self._cells[number].drawn(u[here, :3])
        return mu_i, dphi, path

    def _neighbours(self, mu_o) -> tuple[np.ndarray, np.ndarray]:
        """(the number of the view before each view, the share of the one after it)."""
        place = np.arccos(mu_o) / (0.5 * np.pi) * (VIEWS - 1)
        lower = np.minimum(place.astype(int), VIEWS - 2)
        return lower, place - lower

    def _directions(self, view, light) -> tuple[np.ndarray, np.ndarray]:
        view, light = self._unit(view, "view"), self._unit(light, "light", False)
        try:
            first, second = np.broadcast_arrays(view, light)
            return first, second
        except ValueError:
            raise ArgumentError(f"view {view.shape} and light {light.shape} do not fit together") from None

    def _unit(self, directions, name: str, above: bool = True) -> np.ndarray:
        array = finite_array(directions, name)
        array = array[None] if array.ndim == 1 else array
        if array.ndim != 2 or array.shape[1] != 3:
            raise ArgumentError(f"{name} has the shape {array.shape}: must be (n, 3)")
        if np.abs(np.linalg.norm(array, axis=1) - 1.0).max(initial=0.0) > UNIT:
            raise ArgumentError(f"{name}: must be unit vectors")
        if above and array[:, 2].min(initial=1.0) <= 0.0:
            raise ArgumentError(f"{name}: must have z > 0; make another sampler for the other side")
        return array

    def _angles(self, view, light) -> tuple[np.ndarray, ...]:
        """(mu_o, mu_i, dphi, path); mu_i is 0 for light that no path brings."""
        below = light[:, 2] < 0.0
        mu_i = np.minimum(np.abs(light[:, 2]), 1.0)
        if len(self._paths) == 1:
            mu_i = np.where(below, 0.0, mu_i)
        # Light travels against its direction.
        x, y = -light[:, 0], -light[:, 1]
        dphi = np.arctan2(x * view[:, 1] - y * view[:, 0], x * view[:, 0] + y * view[:, 1])
        return np.minimum(view[:, 2], 1.0), mu_i, dphi, below.astype(int)


def _light(view, mu_i, dphi, path) -> np.ndarray:
    """Unit directions to the light."""
    azimuth = np.arctan2(view[:, 1], view[:, 0]) - dphi + np.pi
    sine = np.sqrt(np.maximum(1.0 - mu_i**2, 0.0))
    return np.column_stack([sine * np.cos(azimuth), sine * np.sin(azimuth), np.where(path == 1, -mu_i, mu_i)])
