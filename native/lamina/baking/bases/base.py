# SPDX-License-Identifier: GPL-3.0-or-later
"""What the bakes of all kinds of base have in common."""

from __future__ import annotations

import operator
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...common.progress import Progress, portion
from ...kinds.bases import PrincipledBase
from ...kinds.table import closure_count
from ...material.stack import Stack
from ...solver.core_calls import thread_pool
from ..fit.between_rows import linear
from ..fit.mixture import Part
from ..fit.slices import Slices, SolvedRows, grid_of, joined, slices
from ..report.fit_report import fit_report
from ..report.input_error import own_errors, range_errors
from .job import CLOSURE_BASES, SEARCH, Basis, Job


class BakedBase(ABC):
    """The bake of a stack on one kind of base. `solved`: the solved rows, after `parts`; `roughnesses`: the axis of
    roughness, empty without one."""

    solved: SolvedRows
    roughnesses: Sequence[float] = ()

    def __init__(self, job: Job):
        self.job, self.stack = job, job.stack
        self.limits, self.search = CLOSURE_BASES[job.basis], SEARCH[job.quality]
        self.grid, self.pool = grid_of(job.stack, job.quality), thread_pool(job.threads)

    @staticmethod
    @abstractmethod
    def most_strips(stack: Stack, limits: Basis) -> int:
        """The largest number of strips of one row, on both sides of a sheet."""

    @abstractmethod
    def parts(self) -> list[Part]:
        """Solves the stack, and fits the parts of the table, in order."""

    @abstractmethod
    def errors(self, header: dict, weights: np.ndarray) -> dict:
        """The report of the table, see lamina.bake."""

    def weights(self, parts: Sequence[Part]) -> np.ndarray:
        """The table, float32 [side, strip, row, column, R G B], with the rows between the solved ones."""
        every = [np.moveaxis(self._all_rows(part), 3, 4) for part in parts]
        return np.concatenate([np.broadcast_to(one, (*one.shape[:4], 3)) for one in every], axis=1, dtype=np.float32)

    def _all_rows(self, part: Part) -> np.ndarray:
        """Weights [side, strip, row, channel, column] of all rows."""
        azimuths = self.solved.azimuths
        return linear(part.weights, self.solved, 2) if azimuths is None else azimuths.whole(part.strips, part.weights)

    def _errors_of_inputs(self, header: dict, weights: np.ndarray, solved: SolvedRows, own: Slices,
                          step: Progress) -> dict:
        """The report, with errors at the base's own values, where the slices are `own`, and over the ranges of its
        inputs, if it has any."""
        job = self.job
        own_error = own_errors(header, weights, self.stack, solved, own, job.threads)
        report = fit_report(closure_count(header), solved, *own_error)
        if job.measures and getattr(self.stack.base, "inputs", True):
            report["input_error"] = range_errors(header, weights, self.stack, job.threads, step)
        return report


class WithInputs(BakedBase):
    """The bake of a stack on a Principled base. `base`: without its `inputs`; `rows`: of roughness, if that is an
    input; `every`: the roughnesses that are solved; `ends`: the metallic values that are solved; `own`: slices at the
    base's own values, where `parts` finds them."""

    rows: int
    own: Slices | None = None

    def __init__(self, job: Job):
        super().__init__(job)
        base = job.stack.base
        assert isinstance(base, PrincipledBase)
        self.base, self.inputs = replace(base, inputs=()), base.inputs
        if "roughness" in base.inputs:
            self.roughnesses = np.linspace(0.0, 1.0, self.rows).tolist()
        self.every = self.roughnesses or [base.roughness]
        self.ends = (0.0, 1.0) if "metallic" in base.inputs else (base.metallic,)
        self.step = portion(job.step, 0.0, 0.75)  # of `parts`

    def errors(self, header: dict, weights: np.ndarray) -> dict:
        job, solved, own = self.job, self.solved, self.own
        if own is None:
            solved, own = self._own(self.stack, portion(job.step, 0.75, 0.8))
        return self._errors_of_inputs(header, weights, solved, own, portion(job.step, 0.8, 1.0))

    def _own(self, stack: Stack, step: Progress) -> tuple[SolvedRows, Slices]:
        """(the solved rows, the slices) at the base's own values."""
        base = stack.given_base
        assert isinstance(base, PrincipledBase)
        if stack.wavelengths is not None and "color" in self.inputs and isinstance(base.color, tuple):
            # Each channel of the input is the color of a gray base, see Stack
            found = [self._own(stack.over(replace(base, color=one)), portion(step, k / 3, (k + 1) / 3))
                     for k, one in enumerate(base.color)]
            channels = [own.each(operator.itemgetter(np.s_[:, :, k:k + 1])) for k, (_, own) in enumerate(found)]
            return found[-1][0], joined(channels, 2)
        solved = self.job.solved(stack, portion(step, 0.0, 0.3))
        return solved, slices(solved, self.grid, self.pool, portion(step, 0.3, 1.0))["reflection"]
