# SPDX-License-Identifier: GPL-3.0-or-later
"""Dusts by mass: the optical thickness per areal mass, and the scattering of their grains.

From the optical-property files of biosnicar-py (Mie theory), at about 615, 545 and 465 nm. Mie grains scatter forward:
at optical thickness 1 they reflect only .02 to .07 at normal incidence. A visibly dusty object needs an optical
thickness of several, or the lower g (about .3 or less) of rough grains and aggregates."""

from __future__ import annotations

import numbers
from dataclasses import dataclass

from .errors import DustError
from .panel import Item

SOURCE = "optical-property files of biosnicar-py (Mie theory) at about 615, 545 and 465 nm"


@dataclass(frozen=True)
class DustMaterial:
    """mass_extinction in m^2/kg, single-scattering albedo, and Henyey-Greenstein g; each R G B. `item`: its entry in
    the panel's list."""

    mass_extinction: tuple[float, float, float]
    albedo: tuple[float, float, float]
    g: tuple[float, float, float]
    item: Item
    source: str = SOURCE


DUSTS = {
    "dust-saharan-1.7um": DustMaterial(
        (379.0, 386.0, 379.0), (0.957, 0.8746, 0.7886), (0.758, 0.796, 0.828),
        Item("dust-saharan-1.7um", "Desert Dust", "Saharan dust of 1.7 micrometres", 0)),
    "dust-saharan-fine-0.85um": DustMaterial(
        (853.0, 807.0, 805.0), (0.978, 0.9227, 0.8642), (0.662, 0.687, 0.74),
        Item("dust-saharan-fine-0.85um", "Desert Dust, Fine", "Saharan dust of 0.85 micrometres", 1)),
    "dust-saharan-coarse-6.6um": DustMaterial(
        (94.5, 94.1, 93.5), (0.8794, 0.7038, 0.6041), (0.834, 0.89, 0.925),
        Item("dust-saharan-coarse-6.6um", "Desert Dust, Coarse", "Saharan dust of 6.6 micrometres", 2)),
    "dust-san-juan-1.7um": DustMaterial(
        (376.0, 385.0, 372.0), (0.9725, 0.9645, 0.9497), (0.747, 0.764, 0.771),
        Item("dust-san-juan-1.7um", "Grey Dust", "San Juan dust of 1.7 micrometres", 3)),
    "dust-mars-like-1.7um": DustMaterial(
        (487.0, 494.0, 490.0), (0.9465, 0.8723, 0.777), (0.764, 0.797, 0.836),
        Item("dust-mars-like-1.7um", "Red Dust", "Mars-like dust of 1.7 micrometres", 4)),
    "ash-mount-st-helens": DustMaterial(
        (650.0, 630.0, 611.0), (0.9215, 0.9084, 0.8853), (0.726, 0.739, 0.758),
        Item("ash-mount-st-helens", "Volcanic Ash", "Ash of Mount St. Helens", 5)),
    "soot-40nm": DustMaterial(
        (10620.0, 11780.0, 13230.0), (0.345, 0.359, 0.376), (0.398, 0.424, 0.459),
        Item("soot-40nm", "Soot", "Soot of 40 nanometres", 6)),
    "snow-100um": DustMaterial(
        (16.53, 16.52, 16.5), (0.999986, 0.999995, 0.999998), (0.8899, 0.8894, 0.8885),
        Item("snow-100um", "Snow, Fine", "Snow grains of 100 micrometres", 7)),
    "snow-500um": DustMaterial(
        (3.28, 3.28, 3.28), (0.999933, 0.999975, 0.999991), (0.8924, 0.8917, 0.8904),
        Item("snow-500um", "Snow, Coarse", "Snow grains of 500 micrometres", 8)),
}  # fmt: skip


def extinction_of(extinction: float | str) -> float:
    """Mass extinction in m^2/g: a given number in (0, 1000], or the green channel of the entry of DUSTS with this id.
    Raises DustError."""
    if isinstance(extinction, str):
        if extinction not in DUSTS:
            raise DustError(f"settling.extinction = {extinction!r}: must be a number or one of {', '.join(DUSTS)}")
        return DUSTS[extinction].mass_extinction[1] * 1e-3
    if isinstance(extinction, bool) or not isinstance(extinction, numbers.Real) or not 0.0 < extinction <= 1000.0:
        raise DustError(f"settling.extinction = {extinction!r}: must lie in (0, 1000] m^2/g, or be the id of a dust")
    return float(extinction)
