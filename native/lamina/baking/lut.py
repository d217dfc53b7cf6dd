# SPDX-License-Identifier: GPL-3.0-or-later
"""The lookup table that a bake makes and a node group reads."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np

from ..common.archive import Damaged, load_archive, save_archive
from ..common.errors import LutError
from . import lut_header


@dataclass(frozen=True, eq=False)
class Lut:
    """Closure weights over the view angle, and the header that describes them.

    `weights`: float32, shape (sides, closures, tau rows, 64 columns, 3). `header`: a JSON object with
    schema, version (of the Lamina that made the table), stack, stack_hash, quality, basis, seed, sides, axes, closures
    (lobe ids, see lamina.lobes, and "transparent" for the unscattered light of a sheet) and report."""

    header: dict
    weights: np.ndarray
    seconds: float = 0.0

    def __repr__(self) -> str:
        shape = " x ".join(map(str, self.weights.shape))
        return (f"<Lut: {len(self.closures)} closures, weights {shape}, {self.header['quality']} quality, fit error "
                f"{self.header['report']['fit_error']:.2%}>")

    @property
    def report(self) -> dict:
        """The accuracy of the table: fit_error (mean relative L2 error of the slices), worst_slice, albedo_error,
        energy_error and more, see lamina.bake. Also the `seconds` of the bake, which are not saved, so equal bakes have
        equal bytes."""
        return {**self.header["report"], "seconds": self.seconds}

    @property
    def closures(self) -> list[str]:
        return self.header["closures"]

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
        except Damaged:
            raise LutError(f"{path}: not a complete Lamina lookup table") from None
        problem = lut_header.problem(header, weights)
        if problem:
            raise LutError(f"{path}: {problem}")
        return cls(header, weights)
