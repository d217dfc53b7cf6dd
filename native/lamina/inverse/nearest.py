# SPDX-License-Identifier: GPL-3.0-or-later
"""The stack of a small library that is nearest to a measured material."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..common.errors import ArgumentError, SolveError, StackError, quoted
from ..common.progress import Progress, portion, stepper
from ..kinds.bases import Conductor, HalfSpace, Lambert, Measured
from ..kinds.boundaries import Interface
from ..kinds.phases import HenyeyGreenstein
from ..material import half_table
from ..material.stack import Stack
from ..solver.sharp_facets import peak_alpha
from ..solver.solve import ScatteringFunction, solve
from .descent import descend
from .free import Free
from .measured_base import read_base
from .measurements import Brdf
from .model import Model
from .template import Template

# Knots of the measured table to which stacks are fitted: tilts and angles of the half vector, and its turn
TILTS, HALVES, TURNS = (0, 6, 10, 15, 21, 28, 36, 44), (2, 6, 10, 14), (0, 16)
GRAZING = 0.17  # least cosine of the fit and of the errors: 80 degrees
# Errors of the fit are relative to the value, and to a share of the median.
RELATIVE, SHARE = 0.1, 0.02
# A stack with more parameters must be better by this factor.
BETTER = 0.97
ENOUGH = 0.01  # with a smaller error no further stack is tried
NARROWEST, NARROWEST_OF_TWO = 0.01, 0.06  # alpha of facets: those below other facets need many azimuth orders
VIEWS = np.cos(np.radians([0.0, 15.0, 30.0, 45.0, 60.0, 70.0, 80.0]))
NODES, DENSITY = (48, 40), 5.0  # of light, by cosine and by azimuth, which is dense about the mirror direction
TELLS = 1.25  # a ratio of measured to fitted light that is worth a sentence


@dataclass(frozen=True, eq=False, repr=False)
class Nearest:
    """What lamina.nearest found.

    stack: the stack, and `kind` its description in words.
    error: the mean over views, up to 80 degrees from the normal, and channels of the share of reflected light that is
        in a wrong direction or of a wrong strength: the integral of the absolute difference over that of the
        measured light.
    worst: the largest such share of a view, and `worst_angle` its angle from the normal in degrees.
    tried: the errors of all stacks that were tried, by description; infinite for one that could not be solved. None is
        tried after one with an error below 1 %.
    remarks: one sentence for each thing that the stack does not show.
    """

    stack: Stack
    kind: str
    error: float
    worst: float
    worst_angle: float
    tried: dict[str, float]
    remarks: tuple[str, ...]

    def __repr__(self) -> str:
        return f"<Nearest: {self.kind}, error {100.0 * self.error:.3g} %>"

    def __str__(self) -> str:
        lines = [f"{self.kind}: mean error {100.0 * self.error:.3g} %, worst {100.0 * self.worst:.3g} % seen "
                 f"{self.worst_angle:.0f} degrees from the normal"]
        return "\n".join([*lines, *self.remarks])


def nearest(measured: Measured | str | os.PathLike, threads: int = 0, progress: Progress | None = None,
            cancel: Callable[[], bool] | None = None) -> Nearest:
    """The stack that comes nearest to a measured material, a lamina.Measured or a file of MERL or RGL.

    Tried are a matte surface, a powder, a rough metal, then a matte surface, a pigmented medium and a metal under a
    rough coat. The best is returned, the simpler of two that are as good. No scipy is needed. `threads` 0 uses every
    hardware thread. `progress(fraction, text)` is called with a share that only rises, 0 to 1. `cancel()` is called
    often; Cancelled is raised if it returns true. Raises MeasurementError, OSError and ArgumentError.
    Method: least squares at some hundred pairs of directions about the mirror direction and away from it; errors on a
    grid of 7 views and 1920 lights."""
    step = stepper("the search for the nearest stack", progress, cancel)
    largest = 0.0
    if isinstance(measured, str | os.PathLike):
        measured, largest = read_base(measured)
    if not isinstance(measured, Measured):
        raise ArgumentError(f"measured = {quoted(measured)}: must be a lamina.Measured, or the path of a .binary or "
                            ".bsdf file")
    Stack([], measured)  # checks the table
    truth = _Truth.of(measured)
    best: tuple[float, np.ndarray, str, Stack, ScatteringFunction] | None = None
    tried = {}
    library = _library(truth.colour, truth.alpha)
    for index, (kind, template) in enumerate(library.items()):
        step(index / len(library), f"Trying {kind}")
        part = portion(step, index / len(library), (index + 1) / len(library))
        try:
            model = Model([truth.points()], template, threads, _saying(part, f"Trying {kind}"))
            model.begin()
            x, _ = descend(model, model.start)
            stack = model.stacks(x)[0]
            solved = solve(stack, "preview", threads)
            errors = truth.errors(solved)
        except (SolveError, StackError):
            tried[kind] = math.inf
            continue
        tried[kind] = float(errors.mean())
        if best is None or tried[kind] < BETTER * best[0]:
            best = tried[kind], errors, kind, stack, solved
        if best[0] < ENOUGH:
            break
    assert best is not None  # a matte surface can always be solved
    error, errors, kind, stack, solved = best
    view = int(np.argmax(errors.max(axis=-1)))
    step(1.0, "Found")
    remarks = truth.remarks(solved)
    if largest > TELLS:
        remarks.insert(0, f"The data reflect up to {largest:.4g} times the light that they receive, and count as "
                          "scaled down.")
    source = f"The nearest stack to a measurement: {kind}, mean error {100.0 * error:.2g} %"
    stack = Stack(stack.layers, stack.base, name=measured.name, source=source)
    return Nearest(stack, kind, error, float(errors.max()), math.degrees(math.acos(VIEWS[view])), tried,
                   tuple(remarks))


def _saying(step: Progress, text: str) -> Progress:
    """A step function that always tells this text."""
    return lambda fraction, _: step(fraction, text)


def _library(colour: Sequence[float], alpha: float) -> dict[str, Template]:
    """The templates by description, simple ones first. `colour`: reflectance by channel; `alpha`: of the highlight."""
    alpha = float(np.clip(alpha, NARROWEST, 0.9))
    wide = float(np.clip(2.0 * alpha, NARROWEST_OF_TWO, 0.9))

    def one(name: str, value: float, low: float, high: float) -> Any:  # a template takes it for a number
        return Free(float(np.clip(value, low, high)), low, high, name)

    def free(name: str, values: Sequence[float], low: float, high: float) -> Any:
        made = [one(f"{name} {index}", value, low, high) for index, value in enumerate(values)]
        return tuple(made) if len(made) > 1 else made[0]

    def metal(width: float, least: float) -> Conductor:
        facing = free("facing", colour, 0.01, 0.99)
        grazing = tuple(0.45 + 0.55 * f for f in facing) if isinstance(facing, tuple) else 0.45 + 0.55 * facing
        return Conductor(facing=facing, grazing=grazing, alpha=one("alpha of the metal", width, least, 1.0))

    def coat(least: float = NARROWEST) -> Interface:
        return Interface(one("ior", 1.5, 1.15, 2.2), one("alpha", alpha, least, 1.0))

    def medium() -> HalfSpace:
        roots = [(1.0 - share) / (1.0 + 1.5 * share) for share in colour]
        return HalfSpace(free("albedo", [1.0 - root * root for root in roots], 0.0, 1.0),
                         HenyeyGreenstein(one("g", 0.2, -0.7, 0.9)))

    def matte() -> Lambert:
        return Lambert(free("reflectance", colour, 0.0, 1.0))

    return {
        "a matte surface": Template([], matte()),
        "a powder": Template([], medium()),
        "a rough metal": Template([], metal(alpha, NARROWEST)),
        "a matte surface under a coat": Template([coat()], matte()),
        "a pigmented medium under a coat": Template([coat()], medium()),
        "a metal under a coat": Template([coat(NARROWEST_OF_TWO)], metal(wide, NARROWEST_OF_TWO)),
    }


@dataclass(frozen=True, eq=False)
class _Truth:
    """A measured material: its table, the reflectance of each channel at 45 degrees, the width of its highlight, and
    its values [view, light, channel] on a grid of light."""

    table: np.ndarray
    colour: list[float]
    alpha: float
    mu_i: np.ndarray
    dphi: np.ndarray
    weight: np.ndarray
    values: np.ndarray

    @classmethod
    def of(cls, base: Measured) -> _Truth:
        table = half_table.table_in(base.table)
        x, wx = np.polynomial.legendre.leggauss(NODES[0])
        y, wy = np.polynomial.legendre.leggauss(NODES[1])
        mu, y = 0.5 * (x + 1.0), 0.5 * (y + 1.0)
        dphi = math.pi * np.sinh(DENSITY * y) / math.sinh(DENSITY)
        slope = math.pi * DENSITY * np.cosh(DENSITY * y) / math.sinh(DENSITY)
        weight = np.outer(0.5 * wx * mu, wy * slope).ravel()
        mu_i, dphi = np.repeat(mu, len(dphi)), np.tile(dphi, len(mu))
        values = np.stack([_values(table, np.full_like(mu_i, view), mu_i, dphi) for view in VIEWS])
        colour = half_table.albedos(table, np.array([math.sqrt(0.5)]))[0]
        return cls(table, np.clip(colour, 0.0, 1.0).tolist(), peak_alpha(base), mu_i, dphi, weight, values)

    def points(self) -> Brdf:
        """The values at chosen knots, as a measurement for a fit."""
        index = np.ix_(TILTS, HALVES, TURNS)
        h, d, c, mu_o, mu_i = (one[index].ravel() for one in half_table.knots())
        seen = (mu_i >= GRAZING) & (mu_o < 1.0)
        h, d, c, mu_o, mu_i = (one[seen] for one in (h, d, c, mu_o, mu_i))
        values = half_table.evaluate(self.table, h, d, c)
        across = np.sqrt((1.0 - mu_o**2) * (1.0 - mu_i**2))
        dphi = np.arccos(np.clip((mu_o * mu_i - np.cos(2.0 * d)) / np.maximum(across, 1e-12), -1.0, 1.0))
        return Brdf(values=values, sigma=SHARE * float(np.median(values)), relative=RELATIVE, mu_o=mu_o, mu_i=mu_i,
                    dphi=dphi)

    def errors(self, solved: ScatteringFunction) -> np.ndarray:
        """The share of wrong light, [view, channel]."""
        away = np.abs(np.stack([self._shown(solved, view) for view in VIEWS]) - self.values)
        return np.einsum("vlc,l->vc", away, self.weight) / np.einsum("vlc,l->vc", self.values, self.weight)

    def _shown(self, solved: ScatteringFunction, view: float) -> np.ndarray:
        grid = solved.brdf(view, self.mu_i[::NODES[1], None], self.dphi[:NODES[1]])
        return grid.reshape(len(self.mu_i), -1)

    def remarks(self, solved: ScatteringFunction) -> list[str]:
        """What the stack does not show: highlights, light back to its source, and reflectance at grazing angles."""
        found = []
        middle = math.sqrt(0.5)
        for words, mu_o, mu_i, dphi in (("the highlight at 45 degrees", middle, middle, 0.0),
                                        ("light back to its source at 45 degrees", middle, middle, math.pi),
                                        ("light at 75 degrees, mirrored", 0.2588, 0.2588, 0.0)):
            measured = _values(self.table, *(np.array([one]) for one in (mu_o, mu_i, dphi)))[0].mean()
            ratio = measured / max(float(solved.brdf(mu_o, mu_i, dphi).mean()), 1e-12)
            if not 1.0 / TELLS < ratio < TELLS:
                found.append(f"In the data {words} is {ratio:.2g} times as bright.")
        return found


def _values(table: np.ndarray, mu_o: np.ndarray, mu_i: np.ndarray, dphi: np.ndarray) -> np.ndarray:
    """Values of a table in 1/sr, (count, channels), at directions as ScatteringFunction.brdf takes them."""
    between = mu_o * mu_i - np.sqrt((1.0 - mu_o**2) * (1.0 - mu_i**2)) * np.cos(dphi)
    along = np.sqrt(np.clip(0.5 * (1.0 + between), 1e-12, 1.0))
    upright = np.minimum((mu_o + mu_i) / (2.0 * along), 1.0)
    turned = np.abs(mu_o - mu_i) / np.maximum(2.0 * np.sqrt((1.0 - upright**2) * (1.0 - along**2)), 1e-9)
    return half_table.evaluate(table, np.arccos(upright), np.arccos(along), np.minimum(turned, 1.0))
