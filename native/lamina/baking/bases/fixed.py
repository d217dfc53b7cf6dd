# SPDX-License-Identifier: GPL-3.0-or-later
"""A base without inputs, or a sheet without a base: closures for all light, and one for specular light of each side."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...closures import narrow_lobes
from ...common.progress import portion, portions
from ...kinds.table import Strip, closure_count
from ...material.stack import Stack
from ..fit.between_rows import spread_beside_clean
from ..fit.dropped_weights import folded
from ..fit.mixture import Mixture, Part, albedos_of
from ..fit.slices import Slices, slices, stated
from ..fit.stack_fit import StackFit
from ..fit.strayed_light import compensated, strayed_report
from ..report.fit_report import fit_report, fitted_errors
from ..report.tau_error import tau_error
from .base import BakedBase
from .job import Basis, Job

# Shares of a bake's time, measured on stacks with a varying layer.
TIME = {"solve": 0.1, "evaluate": 0.6, "fit": 0.1, "base": 0.02, "between": 0.2, "ranges": 0.1}


class Fixed(BakedBase):
    """`seen`: the slices, and `fitted`: the mixtures fitted to them, by kind of light."""

    seen: dict[str, Slices]
    fitted: dict[str, Mixture]
    unused: tuple[str, ...] = ("base", "ranges")  # of TIME

    def __init__(self, job: Job):
        super().__init__(job)
        self.measures_rows = self.stack.varying is not None and job.quality == "final"
        unused = (*self.unused, *(() if self.measures_rows else ("between",)))
        self.steps = portions(job.step, {name: 0.0 if name in unused else share for name, share in TIME.items()})

    @staticmethod
    def most_strips(stack: Stack, limits: Basis) -> int:
        strips = limits.reflected[2] + limits.moving + 1  # and the mirror
        if stack.is_oriented:
            strips += limits.moving  # tilts
        if stack.varying is not None:
            strips += limits.reflected[0]  # closures of the row without the varying layer
        return strips if stack.base is not None else 2 * (strips + limits.transmitted[2] + 1)  # the unscattered light

    def parts(self) -> list[Part]:
        job, stack, grid = self.job, self.stack, self.grid
        self.solved = job.solved(stack, self.steps["solve"])
        self.seen = self._slices()

        # Choose closures and fit their weights, for each kind of light
        self.fit = StackFit(stack, self.solved, grid, self.pool, self.search, self.limits.moving)
        limits = {"reflection": self.limits.reflected, "transmission": self.limits.transmitted}
        self.fitted = {}
        for number, (kind, wanted) in enumerate(self.seen.items()):
            step = portion(self.steps["fit"], number / len(self.seen), (number + 1) / len(self.seen))
            self.fitted[kind] = self.fit(kind, wanted, limits[kind], job.closures(side=kind), step,
                                         kind == "reflection")

        # Correct for light that strays beyond the horizon, and for weights that Cycles drops
        if self.solved.is_sheet:
            self.fitted["transmission"] = compensated(self.fitted["reflection"], self.fitted["transmission"],
                                                      self.seen["transmission"], grid)
        parts = []
        for kind, wanted in self.seen.items():
            fitted = self.fitted[kind] = folded(self.fitted[kind], wanted, grid, self.solved.is_sheet)
            direct = wanted.direct
            if fitted.thicknesses > 1:
                albedo = albedos_of(fitted, grid, False)[:, :, ::fitted.thicknesses]
                weights = spread_beside_clean(fitted.weights, albedo, self.solved)
                fitted = replace(fitted, weights=weights, thicknesses=len(self.solved.axis))
                direct = spread_beside_clean(direct[:, None], np.ones_like(albedo[:, :1]), self.solved)[:, 0]
            parts += [Part.of(fitted.closures, fitted.weights), *Part.shapes_of(fitted)]
            if np.any(wanted.direct):
                name = narrow_lobes.mirror(stack) if kind == "reflection" else "transparent"
                parts.append(Part.single(Strip(name), direct))
        return parts + self._base_parts()

    def errors(self, header: dict, weights: np.ndarray) -> dict:
        errors = fitted_errors(self.fitted, self.seen, self.grid)
        report = fit_report(closure_count(header), self.solved, *errors) | self._errors_between_rows()
        if self.solved.is_sheet:
            report["strayed_light"] = strayed_report(self.fitted, self.seen, stated())
        return report

    def _slices(self) -> dict[str, Slices]:
        """The slices to be fitted, by kind of light."""
        return slices(self.solved, self.grid, self.pool, self.steps["evaluate"])

    def _base_parts(self) -> list[Part]:
        """The parts of the table for the light that an input of the base changes."""
        return []

    def _errors_between_rows(self) -> dict:
        """The report's entry on interpolation between rows, if it is measured."""
        if not self.measures_rows:
            return {}
        found = tau_error(self.solved, self.stack, self.grid, self.pool, self.steps["between"])
        return {"tau_error": found} if found else {}
