# SPDX-License-Identifier: GPL-3.0-or-later
"""A base that another shader renders: the weight of that shader's light below the layers.

The shader's scattering function is unknown, so the light that it sends through the layers is approximate: its own light
towards the viewer, times a weight that depends on the view. For a base of mean reflectance c the weight is
w / (1 - c r), see geometric_series, where r is the share of diffuse light that the layers reflect back to the base. For
a Lambert surface w is known exactly: the directional albedo of A in bases.colored. Light from a metal crosses the
layers twice at nearly the same angle, and has another w. The table holds the geometric mean of both, whose error is as
large for a Lambert surface as for a rough metal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...closures.axes import column_angles
from ...closures.closure_table import view_cosines
from ...common.srgb import LUMINANCE
from ...kinds.bases import Conductor
from ...kinds.fields import channel
from ...kinds.table import BASE_WEIGHT, THROWN_BACK, Strip
from ...material.layers import Medium
from ...solver.solve import ScatteringFunction, solve_with_mirrors
from ..fit.mixture import Part, norms, relative
from ..fit.slices import seen_whole
from .colored import OverBlack

METAL = Conductor(facing=0.9, grazing=0.9, alpha=0.3)  # like aluminium
REFLECTANCES = (0.2, 0.5, 0.8)  # of Lambert surfaces for which the error is measured
UNKNOWN = 0.5  # reflectance of a base that nobody knows
MEASURED_ROWS = 5  # of thickness, for the metal
# Largest factor between the weights for a Lambert surface and for the metal.
MOST = 4.0


class Shader(OverBlack):
    """One weight in place of closures for the light from below.

    The report's `base_error`, worst relative errors over thicknesses of the energy that leaves under a uniform sky:
    `lambert` and `metal`, where the node group has the color of the base as the reflectance; `unknown`, over both where
    the group takes UNKNOWN instead. These are errors of the luminance. `color`: the worst of both in one channel,
    because the light of the shader has one weight for all channels."""

    def errors(self, header: dict, weights: np.ndarray) -> dict:
        # The error of the fit over black, relative to the whole light over a base of the stack's reflectance
        black, fitted, grid = self.seen["reflection"], self.fitted["reflection"], self.grid
        own = self.own()
        whole = norms(own.values, grid)
        errors = relative(np.nan_to_num(fitted.errors) * norms(black.values, grid), whole)
        self.fitted["reflection"], self.seen["reflection"] = replace(fitted, errors=errors), own
        return super().errors(header, weights) | {"base_error": self.base_error}

    def _base_parts(self) -> list[Part]:
        rows = sorted({round(row) for row in np.linspace(0, len(self.solved.rows) - 1, MEASURED_ROWS)})
        metal, bare = self._over_metal(rows)

        # Weights for a Lambert surface, for a metal, and their geometric mean
        diffuse, back, mirrored = self.added.albedo[0], self.thrown_back[0], self.seen["reflection"].whole[0]
        known = channel(METAL.facing, 0)  # its color, which the artist sees; the mean over a uniform sky is .878
        through = np.maximum(metal - mirrored[rows], 0.0) / bare * (1.0 - known * back[rows])
        lit = diffuse[rows] > 1e-6
        ratio = np.where(lit, through / np.where(lit, diffuse[rows], 1.0), 1.0)
        ratio = np.sqrt(np.clip(ratio, 1.0 / MOST, MOST))
        every = np.arange(len(diffuse))
        flat = ratio.reshape(len(rows), -1)
        between = np.stack([np.interp(every, rows, values) for values in flat.T], axis=1).reshape(diffuse.shape)
        weight = np.minimum(diffuse * between, 1.0)

        # The energy over the surfaces that were solved: (row, directional albedos of the surface, its color, exact)
        measured: dict[str, list] = {
            "lambert": [(row, rho, rho, mirrored[row] + rho * diffuse[row] / (1.0 - rho * back[row]))
                        for row in rows for rho in REFLECTANCES],
            "metal": [(row, bare, known, exact) for row, exact in zip(rows, metal, strict=True)]}
        self.base_error = _base_errors(measured, mirrored, weight, back)
        return [Part.single(Strip(role=BASE_WEIGHT), weight[None]),
                Part.single(Strip(role=THROWN_BACK), self.thrown_back)]

    def _over_metal(self, rows: Sequence[int]) -> tuple[np.ndarray, np.ndarray]:
        """Directional albedos of the stack on metal at these of the solved rows, [row, channel, column], and of the
        metal alone, [channel, column]."""
        stack, options = self.stack, (self.job.quality, self.job.threads)
        self.steps["base"](0.0, "Solving the stack on metal")
        full = solve_with_mirrors(stack.over(METAL), *options)
        taus = [] if stack.varying is None else [stack.optics(stack.varying, c)[1] for c in range(stack.channels)]
        shares = self.solved.shares
        functions = [full] if stack.varying is None else [
            full.with_thickness(stack.varying, [shares[row] * tau for tau in taus]) for row in rows]
        nothing = Medium(albedo=[0.5] * stack.channels, tau=0.0)
        bare = solve_with_mirrors(stack.over(METAL, [nothing]), *options)
        found = np.stack([_reflected(function) for function in functions]), _reflected(bare)
        self.steps["base"](0.9, "Solving the stack on metal")
        return found


def _base_errors(measured: dict[str, list], mirrored: np.ndarray, weight: np.ndarray,
                 back: np.ndarray) -> dict[str, float]:
    """The report's `base_error`. `measured`: for each surface, (row, its directional albedos, its color, the exact
    albedos of the stack over it); arrays are [row, channel, column]."""
    errors: dict[str, list[float]] = {"lambert": [], "metal": [], "unknown": [], "color": []}
    for surface, cases in measured.items():
        for row, reflectance, color, albedo in cases:
            exact = _mean(albedo)
            found, blind = (_mean(mirrored[row] + _luminance(weight[row] / (1.0 - told * back[row])) * reflectance)
                            for told in (color, UNKNOWN))
            errors[surface].append(_error(_luminance(found), _luminance(exact)))
            errors["color"].append(_error(found, exact))
            errors["unknown"].append(_error(_luminance(blind), _luminance(exact)))
    return {name: max(found) for name, found in errors.items()}


def _reflected(function: ScatteringFunction) -> np.ndarray:
    """Directional albedos, mirrored light included, [channel, column]."""
    return seen_whole(function, view_cosines()).T


def _mean(albedo: np.ndarray) -> np.ndarray:
    """The mean over views of light under a uniform sky; a view at angle theta has the weight sin 2 theta."""
    weights = np.sin(2.0 * column_angles())
    return (albedo * weights).sum(axis=-1) / weights.sum()


def _luminance(values: np.ndarray) -> np.ndarray:
    """Values with the channels along the first axis as one channel."""
    return values if len(values) == 1 else np.tensordot(LUMINANCE, values, 1)[None]


def _error(found: np.ndarray, exact: np.ndarray) -> float:
    return float(np.abs(found / exact - 1.0).max())
