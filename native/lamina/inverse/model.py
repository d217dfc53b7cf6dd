# SPDX-License-Identifier: GPL-3.0-or-later
"""Differences between measurements and a template as a function of its parameters, with derivatives."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..common.errors import ArgumentError
from ..common.progress import Progress
from ..material.stack import Stack
from .free import Free
from .light import Solver
from .measurements import Measurement
from .template import Template, named

# Steps of differences, relative to the parameter's size; larger ones for beams, whose lateral frequencies are chosen
# anew for each step.
STEP, BEAM_STEP = 1e-4, 1e-2
# Nodes of the search relative to those that a checked solve chooses, and the least number.
FEW, LEAST_NODES = 0.375, 8
# The relative part of sigma is taken of at least this share of the measured value.
LEAST_SHARE = 0.1


class Model:
    """A template and its measurements. Parameters are arrays in the order of `names`.

    Values come from solves with few nodes, which are fast and smooth in the parameters, plus the difference from a
    checked solve at the last call of `correct`."""

    def __init__(self, measurements: Sequence[Measurement], template: Template, threads: int, step: Progress):
        self.measurements = measurements
        self.template = template
        self._variants = [template.changed(one.changes) for one in measurements]
        self.parameters: dict[str, Free] = named([template, *self._variants])
        if not self.parameters:
            raise ArgumentError("template: must have a free parameter, a lamina.Free in place of a number")
        frees = self.parameters.values()
        self.low, self.high = np.array([f.low for f in frees]), np.array([f.high for f in frees])
        self.start = np.array([f.start for f in frees])
        self.step = step
        self.solver = Solver(threads, lambda: step(self._done, self._text))
        self._done, self._text = 0.0, "Begins"
        self._last: tuple[bytes, list[np.ndarray]] | None = None
        self._check_channels()
        self.sigmas: list[np.ndarray] = []
        self._corrections: list[np.ndarray] = []
        self.count = sum(one.values.size for one in measurements)
        if self.count < len(self.start):
            raise ArgumentError(f"measurements hold {self.count} value(s): must hold at least as many as the template "
                                f"has free parameters, {len(self.start)}")

    @property
    def names(self) -> list[str]:
        return list(self.parameters)

    def _check_channels(self) -> None:
        """Raises ArgumentError for a measurement of another number of channels than its stack."""
        for index, (one, stack) in enumerate(zip(self.measurements, self.stacks(self.start), strict=True)):
            if one.channels != stack.channels:
                raise ArgumentError(f"measurements[{index}].values have {one.channels} channel(s): must have "
                                    f"{stack.channels} like the template")

    def stacks(self, x: np.ndarray) -> list[Stack]:
        """The stack of each measurement. Raises StackError."""
        values = dict(zip(self.parameters.values(), x.tolist(), strict=True))
        made: dict[int, Stack] = {}
        for variant in self._variants:
            if id(variant) not in made:
                made[id(variant)] = variant.filled(values)
                made[id(variant)].require_isotropic("a fit")
                made[id(variant)].require_no_flakes("a fit")
        return [made[id(variant)] for variant in self._variants]

    def expected(self, x: np.ndarray) -> list[np.ndarray]:
        """What each measurement would find, shapes (places, channels)."""
        return self._corrected([x])[0]

    def _corrected(self, points: list[np.ndarray]) -> list[list[np.ndarray]]:
        """What each measurement would find, for several sets of parameters."""
        return [[found + correction for found, correction in zip(one, self._corrections, strict=True)]
                for one in self._solved(points)]

    def _solved(self, points: list[np.ndarray]) -> list[list[np.ndarray]]:
        """The same without corrections. One measurement after the other: the core keeps the lobes of rough boundaries
        for the last list of directions."""
        stacks = [self.stacks(x) for x in points]
        found: list[list[np.ndarray]] = [[] for _ in points]
        for number, one in enumerate(self.measurements):
            for index, all_stacks in enumerate(stacks):
                stack = all_stacks[number]
                channels = [self.solver.expected(one, stack, c) for c in range(stack.channels)]
                found[index].append(np.stack(channels, axis=-1))
        return found

    def residuals(self, x: np.ndarray) -> np.ndarray:
        """(expected - measured) / sigma of all values, flat."""
        key = x.tobytes()
        if self._last is None or self._last[0] != key:
            self.solver.forget()
            self._last = key, self.expected(x)
        found = self._differences(self._last[1], [one.values for one in self.measurements])
        self._text = f"Chi-squared {float(np.sum(found**2)):.4g}"
        return found

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """Derivatives of the residuals, shape (values, parameters), by forward differences."""
        self.residuals(x)
        assert self._last is not None
        base = self._last[1]
        points = []
        for index, size in enumerate(self._steps(x)):
            points.append(x.copy())
            points[-1][index] += size if x[index] + size <= self.high[index] else -size
        columns = [self._differences(found, base) / (point[index] - x[index])
                   for index, (point, found) in enumerate(zip(points, self._corrected(points), strict=True))]
        self._done += 0.15 * (1.0 - self._done)
        self.step(self._done, self._text)
        return np.stack(columns, axis=-1)

    def begin(self) -> None:
        """Makes ready for a search: chooses the number of nodes, from a checked solve of the starting values, and takes
        the relative part of sigma of the measured values."""
        self.sigmas = [np.hypot(one.sigma, one.relative * np.abs(one.values)) for one in self.measurements]
        self._corrections = [np.zeros_like(one.values) for one in self.measurements]
        self._last, self.solver.nodes = None, None
        self._solved([self.start])
        self.solver.nodes = max(LEAST_NODES, int(FEW * self.solver.most_nodes))

    def correct(self, x: np.ndarray) -> None:
        """Corrects the values by a checked solve at `x`, and takes the relative part of sigma of the corrected ones:
        taken of noisy values, it would favour the lower ones."""
        rough = self._solved([x])[0]
        self.solver.nodes, few = None, self.solver.nodes
        exact = self._solved([x])[0]
        self.solver.nodes = few
        self._corrections = [right - wrong for right, wrong in zip(exact, rough, strict=True)]
        self.sigmas = [np.hypot(one.sigma, one.relative * np.maximum(np.abs(found), LEAST_SHARE * np.abs(one.values)))
                       for one, found in zip(self.measurements, exact, strict=True)]
        self._last = x.tobytes(), exact

    def _differences(self, first: list[np.ndarray], second: list[np.ndarray]) -> np.ndarray:
        return np.concatenate([((a - b) / sigma).ravel() for a, b, sigma in
                               zip(first, second, self.sigmas, strict=True)])

    def _steps(self, x: np.ndarray) -> np.ndarray:
        """Steps of the parameters. Near the end of a range they are smaller: there, functions of a parameter may be as
        steep as a root."""
        span = self.high - self.low
        size = np.maximum(np.abs(x), 1e-2 * span)
        room = np.maximum(np.minimum(x - self.low, self.high - x), 1e-3 * span)
        share = BEAM_STEP if any(one.needs_lengths for one in self.measurements) else STEP
        return share * np.minimum(size, room)
