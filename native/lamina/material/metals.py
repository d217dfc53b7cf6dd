# SPDX-License-Identifier: GPL-3.0-or-later
"""Metals by name, with sources, and metals by two colours."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from functools import cache, lru_cache
from importlib.resources import files

from ..common.arguments import check_kind
from ..common.errors import StackError, unknown
from .fields import channel, channel_count, check_forms
from .layers import Conductor

GRAZING = math.cos(math.radians(82.0))  # the angle at which Hoffman (2019) gives a metal its second colour


@cache
def _table() -> dict:
    """{name: {facing, grazing, source}}: metals.json, which tools/metal_colours.py computes from published spectra."""
    return json.loads(files(__package__).joinpath("metals.json").read_text(encoding="utf-8"))


def names() -> list[str]:
    """The metals that conductor() knows."""
    return sorted(_table())


def conductor(name: str, alpha: float = 0.0, distribution: str = "ggx") -> Conductor:
    """A metal of the table by its two colours in air, linear Rec. 709 under D65: the reflectance of its published
    spectrum, integrated with the CIE 1931 observer. What exceeds 1 (the red of gold) is outside the gamut and is 1.
    Raises UnknownName, a KeyError and StackError."""
    entry = _entry(name)
    return Conductor(facing=tuple(entry["facing"]), grazing=tuple(entry["grazing"]), alpha=alpha,
                     distribution=distribution)


def source(name: str) -> str:
    """Where a metal's colours come from. Raises UnknownName, a KeyError and StackError."""
    return f"{_entry(name)['source']}; spectrum integrated with the CIE 1931 observer under D65"


def _entry(name: str) -> dict:
    if not isinstance(name, str) or name not in _table():
        raise unknown("metal", name, names())
    return _table()[name]


def reflectance(mu: float, eta: float, k: float) -> float:
    """Fresnel reflectance of a metal in air for unpolarised light at cosine `mu`."""
    index = complex(eta, k) ** 2
    inside = (index - (1.0 - mu * mu)) ** 0.5
    across, along = (mu - inside) / (mu + inside), (index * mu - inside) / (index * mu + inside)
    return 0.5 * (abs(across) ** 2 + abs(along) ** 2)


def colours_of(metal: Conductor) -> tuple[list[float], list[float]]:
    """(facing, grazing) colours of a conductor, given in either form: its reflectances in air at 0 and 82 degrees,
    one a channel. Raises StackError."""
    values = check_forms(check_kind(metal, "metal", Conductor, "a lamina.Conductor"), "conductor")
    channels = channel_count([(f"conductor.{name}", value) for name, value in values.items()])
    eta, k = indices_of(replace(metal, **values), channels, "conductor")
    pairs = [(channel(eta, c), channel(k, c)) for c in range(channels)]
    return [reflectance(1.0, *pair) for pair in pairs], [reflectance(GRAZING, *pair) for pair in pairs]


def indices_of(metal: Conductor, channels: int, path: str) -> tuple:
    """(eta, k) of a checked conductor, found from its two colours where it is given by these.

    Raises StackError, naming `path` and the range, when no metal of its facing colour has its grazing one."""
    if metal.facing is None:
        return metal.eta, metal.k
    found = []
    for index in range(channels):
        facing, grazing = channel(metal.facing, index), channel(metal.grazing, index)
        low, high = _range(facing)
        if not low - 1e-5 <= grazing <= high + 1e-5:
            where = f"{path}.grazing" + (f"[{index}]" if isinstance(metal.grazing, tuple) else "")
            least, most = math.ceil(low * 1e4) / 1e4, math.floor(high * 1e4) / 1e4
            between = f"between {least:g} and {most:g}" if least < most else f"{round(low, 6):g}"
            raise StackError(f"{where} = {grazing:g}: a metal of facing colour {facing:g} shows {between} "
                             "at 82 degrees")
        found.append(_indices(facing, grazing))
    return tuple(eta for eta, _ in found), tuple(k for _, k in found)


def _extinction(facing: float, eta: float) -> float:
    """k of a metal of that reflectance at normal incidence (Gulbrandsen 2014)."""
    return math.sqrt(max(0.0, (facing * (eta + 1.0) ** 2 - (eta - 1.0) ** 2) / (1.0 - facing)))


@lru_cache(maxsize=1024)
def _ends(facing: float) -> tuple[float, float, float]:
    """(facing, least eta, largest eta): those with a real k, inside what a Conductor may have. A perfect
    mirror is no metal of finite index; it is taken as one that lacks a millionth."""
    facing = min(facing, 1.0 - 1e-6)
    root = math.sqrt(facing)
    low, high = max((1.0 - root) / (1.0 + root), 1e-3), min((1.0 + root) / (1.0 - root), 100.0)
    if _extinction(facing, high) > 100.0:
        high = _bisect(lambda eta: _extinction(facing, eta) <= 100.0, low, high)
    return facing, low, high


def _range(facing: float) -> tuple[float, float]:
    """What metals of that facing colour show at 82 degrees; it falls as eta grows."""
    facing, low, high = _ends(facing)
    return tuple(reflectance(GRAZING, eta, _extinction(facing, eta)) for eta in (high, low))


@lru_cache(maxsize=4096)
def _indices(facing: float, grazing: float) -> tuple[float, float]:
    """(eta, k), to 12 digits."""
    facing, low, high = _ends(facing)
    eta = _bisect(lambda eta: reflectance(GRAZING, eta, _extinction(facing, eta)) >= grazing, low, high)
    return float(f"{eta:.12g}"), float(f"{_extinction(facing, eta):.12g}")


def _bisect(holds, low: float, high: float) -> float:
    """The largest number up to which `holds` does."""
    if holds(high):
        return high
    while high - low > 1e-15 * high:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low
