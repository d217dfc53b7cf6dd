# SPDX-License-Identifier: GPL-3.0-or-later
"""Measurements from files of three formats."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

from ..common.arguments import check_number, check_path, check_whole
from ..common.errors import ArgumentError, MeasurementError, quoted
from .csv_file import read_csv
from .measurements import Brdf, Measurement
from .merl import read_merl
from .rgl import read_rgl


def load(path: str | os.PathLike, count: int = 300, grazing: float = 75.0, wavelengths: Sequence[float] | None = None,
         sigma: float = 0.0, relative: float = 0.0, changes: Mapping[str, object] | None = None) -> list[Measurement]:
    """The measurements in a file, for lamina.fit.

    `.binary`: an isotropic material of MERL (Matusik et al. 2003), red, green and blue. `.bsdf`: an isotropic material
    of RGL (Dupuy and Jakob 2018), also of lamina.rgl.save_bsdf: red, green and blue, or a spectrum, at the
    `wavelengths` (nm) or at all of the file. Of both, `count` directions are taken, spread evenly over the grid of the
    file, up to `grazing` degrees from the normal, where few instruments see well.

    `.csv`: a line of names, then lines of numbers; lines that begin with # are comments. Places: `mu_o` or
    `theta_o_deg` or `theta_o_rad`, the same of `mu_i`, `dphi_deg` or `dphi_rad` (0 where light keeps its azimuth),
    `r_mm`. Values: `brdf`, `btdf` (1/sr), `reflectance`, `transmittance` (0 to 1; diffuse light without a column of an
    angle), `reflected_per_mm2`, `transmitted_per_mm2`; one column per channel: `brdf_red`, `brdf_green`. Red, green and
    blue, or r, g and b, are taken in this sequence, channels of other names in that of the columns. Standard errors:
    `sigma`, `relative` for all values of a line, `sigma_brdf` for those of a kind, `sigma_brdf_red` for one column.
    Each kind of values becomes one measurement.

    `sigma`, `relative` and `changes`: see lamina.measurements.Measurement; columns of a CSV file come first. Raises
    MeasurementError for a file that cannot be read, ArgumentError and OSError."""
    count = check_whole(count, "count", 1, 1_000_000)
    grazing = check_number(grazing, "grazing", "must lie in (0, 90) degrees", lambda angle: 0.0 < angle < 90.0)
    common: dict[str, Any] = {"sigma": sigma, "relative": relative, "changes": changes}
    path = check_path(path)
    suffix = path.suffix.lower()
    if wavelengths is not None and suffix != ".bsdf":
        raise ArgumentError(f"wavelengths = {quoted(wavelengths)}: only a .bsdf file has them")
    if suffix == ".csv":
        return read_csv(path, **common)
    if suffix not in (".binary", ".bsdf"):
        raise MeasurementError(f"{path}: unknown format: must be .binary (MERL), .bsdf (RGL) or .csv")
    found = (read_merl(path) if suffix == ".binary" else read_rgl(path, wavelengths)).some(count, grazing)
    if not len(found.values):
        raise MeasurementError(f"{path}: no value up to {grazing:g} degrees from the normal")
    try:
        return [Brdf(values=found.values, mu_o=found.mu_o, mu_i=found.mu_i, dphi=found.dphi, **common)]
    except ArgumentError as error:
        raise MeasurementError(f"{path}: {error}") from None
