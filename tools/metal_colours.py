# SPDX-License-Identifier: GPL-3.0-or-later
"""Computes the colours of lamina's metals by name, and writes native/lamina/kinds/metals.json.

    python tools/metal_colours.py

Input: the published indices n and k of each metal, in native/lamina/material/metal_spectra, and lamina's table of the
observer.
A colour is the Fresnel reflectance at one angle, integrated over 380 to 780 nm with the CIE 1931 standard observer
under illuminant D65, as linear Rec. 709. D65 is the white point of Rec. 709, so a perfect mirror is (1, 1, 1).
"""

import csv
import json
from pathlib import Path

import numpy as np

from lamina.common.observer import rec709_under
from lamina.metals import GRAZING, reflectance

TOOLS = Path(__file__).resolve().parent
SPECTRA = TOOLS.parent / "native/lamina/material/metal_spectra"
OUTPUT = TOOLS.parent / "native/lamina/kinds/metals.json"
DIGITS = 4
SOURCE = "# Source: "


def read_table(path: Path) -> np.ndarray:
    """The rows of numbers of a CSV file with comments and a line of names, as columns."""
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return np.array([[float(cell) for cell in row] for row in list(csv.reader(lines))[1:]]).T


def source(name: str) -> str:
    """Where the indices of a metal were published."""
    lines = (SPECTRA / f"{name}.csv").read_text(encoding="utf-8").splitlines()
    return next(line.removeprefix(SOURCE) for line in lines if line.startswith(SOURCE))


def names() -> list[str]:
    """The metals that have a spectrum."""
    return sorted(path.stem for path in SPECTRA.glob("*.csv"))


def rec709(name: str, mu: float) -> np.ndarray:
    """Reflectance of a metal at cosine `mu` under D65: linear Rec. 709, not clipped."""
    wavelengths, response = rec709_under()
    nm, n, k = read_table(SPECTRA / f"{name}.csv")
    indices = zip(np.interp(wavelengths, nm, n), np.interp(wavelengths, nm, k), strict=True)
    return response @ np.array([reflectance(mu, eta, kappa) for eta, kappa in indices])


def colours(name: str) -> tuple[list[float], list[float]]:
    """(facing, grazing) colours for a Conductor. A value above 1 lies outside the gamut of Rec. 709 and is set to 1,
    the largest reflectance. A channel with facing reflectance 1 has reflectance 1 at every angle."""
    facing, grazing = (np.clip(rec709(name, mu), 0.0, 1.0) for mu in (1.0, GRAZING))
    grazing[facing == 1.0] = 1.0
    return tuple(np.round(colour, DIGITS).tolist() for colour in (facing, grazing))


def table() -> dict:
    """{name: {facing, grazing, source}} of all metals."""
    return {name: {**dict(zip(("facing", "grazing"), colours(name), strict=True)), "source": source(name)}
            for name in names()}


def text() -> str:
    """The text of metals.json."""
    entries = [f"  {json.dumps(name)}: {{\n" + ",\n".join(
        f"    {json.dumps(key)}: {json.dumps(value)}" for key, value in entry.items()) + "\n  }"
        for name, entry in table().items()]
    return "{\n" + ",\n".join(entries) + "\n}\n"


if __name__ == "__main__":
    OUTPUT.write_text(text(), encoding="utf-8")
