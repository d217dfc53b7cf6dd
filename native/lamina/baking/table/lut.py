# SPDX-License-Identifier: GPL-3.0-or-later
"""The lookup table that a bake makes and a node group reads."""

from __future__ import annotations

import functools
import os
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from ...common.archive import Damaged, load_archive, save_archive
from ...common.arguments import check_flag, finite_array
from ...common.by_content import ByContent
from ...common.errors import ArgumentError, LutError
from ...common.progress import Progress
from ...kinds.table import closure_count
from ...material.any_stack import AnyStack, as_stack
from ...material.stack import Stack
from ..fit.fitted_function import FittedFunction
from ..report.comparison import Comparison, compare
from ..report.lobe_picture import lut_picture
from . import labelled
from .header import problem

_UNCOVERED = "uncovered"  # the entry of the header, and the array

@dataclass(frozen=True, eq=False)
class Lut(ByContent):
    """Closure weights over the view angle, and the header that describes them.

    `weights`: float32, shape (sides, closures, rows, 64 columns, 3); rows are thicknesses tau; for an anisotropic stack
    azimuths, each with all thicknesses. `header`: a JSON object with schema, version (of the Lamina that made the
    table), stack, stack_hash, quality, basis, seed, sides, axes, closures (lobe ids, see lamina.lobes; "transparent"
    for the unscattered light of a sheet; "shape/moving:N" for a strip that holds roughness, anisotropy and tilt of a
    lobe that moves with the view; "shape/oriented:N" and "tilt/oriented:N" for one of an anisotropic stack) and report.
    The table of a stack with a varying interface has a second table, `uncovered`: its header is an entry of `header`,
    and its weights are `uncovered_weights`."""

    header: dict
    weights: np.ndarray
    seconds: float = field(default=0.0, compare=False)
    uncovered_weights: np.ndarray | None = None

    def __repr__(self) -> str:
        shape = " x ".join(map(str, self.weights.shape))
        return (f"<Lut: {closure_count(self.header)} closures, weights {shape}, {self.header['quality']} quality, "
                f"fit error {self.header['report']['fit_error']:.2%}>")

    def _repr_html_(self) -> str:
        return lut_picture(self)

    @property
    def report(self) -> dict:
        """The accuracy of the table: fit_error (mean relative L2 error of the slices), worst_slice, albedo_error,
        energy_error and more, see lamina.bake. Also the `seconds` of the bake, which are not saved, so equal bakes have
        equal bytes."""
        return {**self.header["report"], "seconds": self.seconds}

    @property
    def closures(self) -> list[str]:
        """The names of the closures, in the order of their weights."""
        return self.header["closures"]

    @functools.cached_property
    def stack(self) -> Stack:
        """The stack that was baked, in canonical form: albedo and optical thickness of each channel, without names.
        Raises StackError for a table whose header holds no valid stack."""
        return Stack.from_json(self.header["stack"])

    @functools.cached_property
    def uncovered(self) -> Lut | None:
        """The table of the stack without the film of its varying interface; None if no interface varies."""
        weights = self.uncovered_weights
        return None if weights is None else Lut(self.header["uncovered"], weights)

    def evaluate(self, mu_o, mu_i, dphi, path: str = "reflect", side: str = "top", tau=None, color=None,
                 metallic: float | None = None, *, roughness: float | None = None, coverage=None,
                 phi_o=0.0) -> np.ndarray:
        """The fitted function in 1/sr, as Cycles renders it: a BRDF, or with `path` "transmit" a BTDF.

        Arguments are those of ScatteringFunction.brdf and btdf: cosines `mu_o` of the viewer and `mu_i` of the light in
        (0, 1], `dphi` in radians with 0 forward; light enters on `side`. Arrays broadcast. Shape: broadcast + (3,).
        `tau`: the thickness of the varying layer, in [0, largest], by default the largest; an array broadcasts too.
        `color`, `metallic`, `roughness`: inputs of the node group in [0, 1], by default those of the stack.
        `coverage`: the share of the surface that has the film of the varying interface, in [0, 1], by default 1; an
        array broadcasts too. Between 0 and 1 the function is the mixture of that with and that without the film.
        `phi_o`: azimuth of the viewer from the surface's tangent in radians, for anisotropic facets; an array
        broadcasts too.

        A mirror closure with a width counts; perfectly specular and unscattered light does not. The light of a shader
        below a ShaderBase is unknown and left out. Raises ArgumentError, and StackError as `stack` does."""
        return self._mixed(coverage, tau, (color, metallic, roughness),
                           lambda function, tau: (function.values(mu_o, mu_i, dphi, path, side, tau, phi_o),))[0]

    def reflectance(self, mu_o, side: str = "top", parts: bool = False, tau=None, color=None,
                    metallic: float | None = None, roughness: float | None = None, coverage=None, *, phi_o=0.0):
        """The directional albedo that Cycles shows under uniform light from above, for views with cosine `mu_o` on
        `side`. Shape: broadcast + (3,). By reciprocity it is the reflectance of a beam from there, without the light of
        a sheet that strays to the wrong side (docs/limits.md). `parts`: the pair (by closures that spread light, by
        mirrors). Other arguments are those of `evaluate`."""
        spread, direct = self._mixed(coverage, tau, (color, metallic, roughness),
                                     lambda function, tau: function.albedo(mu_o, "reflect", side, tau, phi_o))
        return (spread, direct) if check_flag(parts, "parts") else spread + direct

    def transmittance(self, mu_o, side: str = "top", parts: bool = False, tau=None, coverage=None):
        """Like `reflectance`, for light from the other side of a sheet; the parts are (spread, unscattered)."""
        spread, direct = self._mixed(coverage, tau, (), lambda function, tau: function.albedo(mu_o, "transmit", side,
                                                                                              tau, 0.0))
        return (spread, direct) if check_flag(parts, "parts") else spread + direct

    def _mixed(self, coverage, tau, inputs: tuple, values: Callable[..., tuple]) -> tuple[np.ndarray, ...]:
        """The arrays `values(function, tau)` of the fitted function with these inputs, at a coverage."""
        found = values(FittedFunction(self.header, self.weights, self.stack.given_base, *inputs), tau)
        bare = self.uncovered
        if coverage is None:
            return found
        if bare is None:
            raise ArgumentError("coverage: must be left out, no interface of this table varies")
        share = finite_array(coverage, "coverage")
        if np.any((share < 0.0) | (share > 1.0)):
            raise ArgumentError(f"coverage = {coverage}: must lie in [0, 1]")
        has_thickness = bare.header["axes"]["tau"]["count"] > 1
        others = values(FittedFunction(bare.header, bare.weights, bare.stack.given_base, *inputs),
                        tau if has_thickness else None)
        share = np.asarray(share)[..., None]
        return tuple(share * one + (1.0 - share) * other for one, other in zip(found, others, strict=True))

    def compare(self, stack: AnyStack | None = None, threads: int = 0, progress: Progress | None = None,
                cancel: Callable[[], bool] | None = None) -> Comparison:
        """The errors of the fitted function against the exactly solved `stack`, by default the one that was baked. The
        errors are measured again from the stored weights, at the table's quality, on the grids of the bake.

        They are those of the report. A base with inputs is compared at the values of the stack's own base; for other
        values, give a `stack` with another base. Over a ShaderBase, the light over a black base is
        compared, relative to the whole light over a base of the stack's reflectance.

        `stack` must have a varying layer of the same largest thickness as the table, or none like the table, and must
        be a sheet if the table is one. `progress` and `cancel` are those of lamina.bake. Raises ArgumentError,
        StackError, SolveError and Cancelled."""
        compared = self.stack if stack is None else as_stack(stack)
        return compare(self.header, self.weights, self.stack, compared, threads, progress, cancel)

    def to_xarray(self):
        """An xarray.Dataset: `weights` (side, closure, roughness, tau, view_angle, color), and the report's
        `slice_errors`. Axes have coordinates, and units are attributes; `mu_o` is a second coordinate of view_angle.
        Anisotropic stacks have an axis `azimuth` before tau; their errors have `solved_azimuth`, without coordinates.
        An axis that the table does not have has the single value 0; errors of a table with several roughnesses have no
        such axis, and are those at the base's own roughness. Raises ExtraMissing without xarray."""
        return labelled.dataset(self.header, self.weights)

    def image(self) -> np.ndarray:
        """The weights as an image, float32, shape (height, 64, 4), bottom row first: one strip of rows
        for each closure of each side, alpha 1."""
        sides, closures, rows, columns, _ = self.weights.shape
        texels = np.ones((sides * closures * rows, columns, 4), np.float32)
        texels[:, :, :3] = self.weights.reshape(-1, columns, 3)
        return texels

    def save(self, path: str | os.PathLike) -> None:
        """Writes the table as .npz, completely or not at all. Raises OSError."""
        more = {} if self.uncovered_weights is None else {_UNCOVERED: self.uncovered_weights}
        save_archive(path, self.header, weights=self.weights, **more)

    @classmethod
    def load(cls, path: str | os.PathLike) -> Lut:
        """Reads a table. Raises LutError for a file that is truncated, foreign, of a newer schema, or has an
        inconsistent header, and OSError when it cannot be opened."""
        try:
            header, (weights,) = load_archive(path, "weights")
            has_more = isinstance(header, dict) and _UNCOVERED in header
            without = load_archive(path, _UNCOVERED)[1][0] if has_more else None
        except Damaged as error:
            raise LutError(f"{path}: not a complete Lamina lookup table: {error}") from None
        if found := problem(header, weights, without):
            raise LutError(f"{path}: {found}")
        return cls(header, weights, uncovered_weights=without)
