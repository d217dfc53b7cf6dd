# SPDX-License-Identifier: GPL-3.0-or-later
"""The lookup table that a bake makes and a node group reads."""

from __future__ import annotations

import functools
import os
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from ...common.archive import Damaged, load_archive, save_archive
from ...common.by_content import ByContent
from ...common.errors import LutError
from ...common.progress import Progress
from ...material.any_stack import AnyStack, as_stack
from ...material.stack import Stack
from ..fit.fitted_function import FittedFunction
from ..report.comparison import Comparison, compare
from ..report.lobe_picture import lut_picture
from . import labelled
from .header import problem


@dataclass(frozen=True, eq=False)
class Lut(ByContent):
    """Closure weights over the view angle, and the header that describes them.

    `weights`: float32, shape (sides, closures, tau rows, 64 columns, 3). `header`: a JSON object with
    schema, version (of the Lamina that made the table), stack, stack_hash, quality, basis, seed, sides, axes, closures
    (lobe ids, see lamina.lobes, and "transparent" for the unscattered light of a sheet) and report."""

    header: dict
    weights: np.ndarray
    seconds: float = field(default=0.0, compare=False)

    def __repr__(self) -> str:
        shape = " x ".join(map(str, self.weights.shape))
        return (f"<Lut: {len(self.closures)} closures, weights {shape}, {self.header['quality']} quality, fit error "
                f"{self.header['report']['fit_error']:.2%}>")

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
        return self.header["closures"]

    @functools.cached_property
    def stack(self) -> Stack:
        """The stack that was baked, in canonical form: albedo and optical thickness of each channel, without names.
        Raises StackError for a table whose header holds no valid stack."""
        return Stack.from_json(self.header["stack"])

    def evaluate(self, mu_o, mu_i, dphi, path: str = "reflect", side: str = "top", tau=None, color=None,
                 metallic: float | None = None, roughness: float | None = None) -> np.ndarray:
        """The fitted function in 1/sr, as Cycles renders it: a BRDF, or with `path` "transmit" a BTDF.

        Arguments are those of ScatteringFunction.brdf and btdf: cosines `mu_o` of the viewer and `mu_i` of the light in
        (0, 1], `dphi` in radians with 0 forward; light enters on `side`. Arrays broadcast. Shape: broadcast + (3,).
        `tau`: the thickness of the varying layer, in [0, largest], by default the largest; an array broadcasts too.
        `color`, `metallic`, `roughness`: inputs of the node group in [0, 1], by default those of the stack.

        A mirror closure with a width counts; perfectly specular and unscattered light does not. The light of a shader
        below a ShaderBase is unknown and left out. Raises ArgumentError, and StackError as `stack` does."""
        function = FittedFunction(self.header, self.weights, self.stack.base, color, metallic, roughness)
        return function.values(mu_o, mu_i, dphi, path, side, tau)

    def reflectance(self, mu_o, side: str = "top", parts: bool = False, tau=None, color=None,
                    metallic: float | None = None, roughness: float | None = None):
        """The directional albedo that Cycles shows under uniform light from above, for views with cosine `mu_o` on
        `side`. Shape: broadcast + (3,). By reciprocity it is the reflectance of a beam from there. `parts`: the pair
        (by closures that spread light, by mirrors). Other arguments are those of `evaluate`."""
        return self._albedo("reflect", mu_o, side, parts, tau, color, metallic, roughness)

    def transmittance(self, mu_o, side: str = "top", parts: bool = False, tau=None):
        """Like `reflectance`, for light from the other side of a sheet; the parts are (spread, unscattered)."""
        return self._albedo("transmit", mu_o, side, parts, tau, None, None, None)

    def _albedo(self, path: str, mu_o, side: str, parts: bool, tau, color, metallic, roughness):
        function = FittedFunction(self.header, self.weights, self.stack.base, color, metallic, roughness)
        spread, direct = function.albedo(mu_o, path, side, tau)
        return (spread, direct) if parts else spread + direct

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
        An axis that the table does not have has the single value 0; errors of a table with several roughnesses have no
        such axis, and are those at the base's own roughness. Raises ExtraMissing without xarray."""
        return labelled.dataset(self.header, self.weights)

    def image(self) -> np.ndarray:
        """The weights as an image, float32, shape (height, 64, 4), bottom row first: one strip of tau rows
        for each closure of each side, alpha 1."""
        sides, closures, rows, columns, _ = self.weights.shape
        texels = np.ones((sides * closures * rows, columns, 4), np.float32)
        texels[:, :, :3] = self.weights.reshape(-1, columns, 3)
        return texels

    def save(self, path: str | os.PathLike) -> None:
        """Writes the table as .npz, completely or not at all. Raises OSError."""
        save_archive(path, self.header, weights=self.weights)

    @classmethod
    def load(cls, path: str | os.PathLike) -> Lut:
        """Reads a table. Raises LutError for a file that is truncated, foreign, of a newer schema, or has an
        inconsistent header, and OSError when it cannot be opened."""
        try:
            header, (weights,) = load_archive(path, "weights")
        except Damaged as error:
            raise LutError(f"{path}: not a complete Lamina lookup table: {error}") from None
        if found := problem(header, weights):
            raise LutError(f"{path}: {found}")
        return cls(header, weights)
