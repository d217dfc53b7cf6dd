# SPDX-License-Identifier: GPL-3.0-or-later
"""The package's tables of spectra: CSV files with comments, a line of names, and nanometres in the first column."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

from ..kinds.spectra import Spectrum


@cache
def read_spectra(folder: str, name: str) -> tuple[Spectrum, ...]:
    """The columns of a table beside that of the wavelengths."""
    rows = [line.split(",") for line in _lines(folder, name) if not line.startswith("#")][1:]
    wavelengths, *columns = zip(*(map(float, row) for row in rows), strict=True)
    return tuple(Spectrum(wavelengths, values) for values in columns)


def comment(folder: str, name: str, key: str) -> str:
    """The text of a comment '# key: text'."""
    start = f"# {key}: "
    return next(line.removeprefix(start) for line in _lines(folder, name) if line.startswith(start))


@cache
def _lines(folder: str, name: str) -> list[str]:
    return (files(__package__) / folder / f"{name}.csv").read_text(encoding="utf-8").splitlines()
