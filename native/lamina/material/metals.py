# SPDX-License-Identifier: GPL-3.0-or-later
"""Metals by name, with sources, and metals by two colours."""

from __future__ import annotations

import math
from dataclasses import replace

from ..common.arguments import check_kind, check_whole
from ..common.errors import ArgumentError, StackError, quoted, unknown
from ..kinds.bases import Conductor
from ..kinds.fields import Channels, channel, channel_count, check_forms
from ..kinds.flakes import Flakes
from ..kinds.metals import GRAZING, grazing_range, indices, reflectance, table
from ..kinds.spectra import MOST_SAMPLES, Spectrum
from .spectrum_files import read_spectra


def names() -> list[str]:
    """The names of metals that conductor() accepts."""
    return sorted(table())


def conductor(name: str, alpha: float = 0.0, distribution: str = "ggx") -> Conductor:
    """A metal of the table by its two colours in air, linear Rec. 709 under D65: the reflectance of its published
    spectrum, integrated with the CIE 1931 observer. Values above 1 (the red of gold) are outside the gamut and set to
    1. Raises UnknownName, a KeyError and StackError."""
    entry = _entry(name)
    return Conductor(facing=tuple(entry["facing"]), grazing=tuple(entry["grazing"]), alpha=alpha,
                     distribution=distribution)


def flakes(name: str, tau: Channels, alpha: float) -> Flakes:
    """Flakes of a metal of the table by its two colours, see conductor. Raises UnknownName, a KeyError and
    StackError."""
    entry = _entry(name)
    return Flakes(tau, alpha, facing=tuple(entry["facing"]), grazing=tuple(entry["grazing"]))


def spectral_indices(name: str) -> tuple[Spectrum, Spectrum]:
    """(n, k) of a metal as published. Raises UnknownName, a KeyError and StackError."""
    _entry(name)
    n, k = read_spectra("metal_spectra", name)
    return n, k


def source(name: str) -> str:
    """The source of a metal's colours. Raises UnknownName, a KeyError and StackError."""
    return f"{_entry(name)['source']}; spectrum integrated with the CIE 1931 observer under D65"


def _entry(name: str) -> dict:
    if not isinstance(name, str) or name not in table():
        raise unknown("metal", name, names())
    return table()[name]


def colours_of(metal: Conductor) -> tuple[list[float], list[float]]:
    """(facing, grazing) colours of a conductor, given in either form: its reflectances in air at 0 and 82 degrees,
    one per channel. Raises StackError."""
    values: dict = check_forms(check_kind(metal, "metal", Conductor, "a lamina.Conductor"), "conductor")
    if "metal" in values:
        raise StackError("conductor.metal: must be in a Stack, which has wavelengths; conductor(name) has the colours")
    channels = channel_count([(f"conductor.{name}", value) for name, value in values.items()])
    eta, k = indices_of(metal, channels, "conductor")
    pairs = [(channel(eta, c), channel(k, c)) for c in range(channels)]
    return [reflectance(1.0, *pair) for pair in pairs], [reflectance(GRAZING, *pair) for pair in pairs]


def indices_of(metal: Conductor | Flakes, channels: int, path: str) -> tuple:
    """(eta, k) of a conductor or of metal flakes, computed from its two colours if they are given: one number or one
    per channel; (None, None) of a metal by its name.

    Raises ArgumentError, and StackError, with `path` and the possible range, if no metal with its facing colour has its
    grazing colour."""
    if not isinstance(metal, Conductor | Flakes):
        raise ArgumentError(f"metal = {quoted(metal)}: must be a lamina.Conductor or lamina.Flakes")
    check_whole(channels, "channels", 1, MOST_SAMPLES)
    values: dict = check_forms(metal, path)
    metal = replace(metal, **values)
    if metal.facing is None:
        return metal.eta, metal.k
    found = []
    for index in range(channels):
        facing, grazing = channel(metal.facing, index), channel(metal.grazing, index)
        low, high = grazing_range(facing)
        if not low - 1e-5 <= grazing <= high + 1e-5:
            where = f"{path}.grazing" + (f"[{index}]" if isinstance(metal.grazing, tuple) else "")
            least, most = math.ceil(low * 1e4) / 1e4, math.floor(high * 1e4) / 1e4
            between = f"between {least:g} and {most:g}" if least < most else f"{round(low, 6):g}"
            raise StackError(f"{where} = {grazing:g}: a metal of facing colour {facing:g} shows {between} "
                             "at 82 degrees")
        found.append(indices(facing, grazing))
    return tuple(eta for eta, _ in found), tuple(k for _, k in found)
