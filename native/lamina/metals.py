# SPDX-License-Identifier: GPL-3.0-or-later
"""Metals by name, with sources, and metals by two colours."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

from .arguments import check_kind
from .errors import StackError, unknown
from .fields import channel, channel_count, check_forms
from .layers import Conductor

WAVELENGTHS = (615.0, 545.0, 465.0)  # nm: R, G, B
GRAZING = math.cos(math.radians(82.0))  # the angle at which Hoffman (2019) gives a metal its second colour

_NOBLE = "P. B. Johnson and R. W. Christy, Optical constants of the noble metals, Phys. Rev. B 6, 4370 (1972)"
_TRANSITION = "P. B. Johnson and R. W. Christy, Optical constants of transition metals, Phys. Rev. B 9, 5056 (1974)"
_WERNER = ("W. S. M. Werner, K. Glantschnig and C. Ambrosch-Draxl, J. Phys. Chem. Ref. Data 38, 1013 (2009), "
           "derived from electron energy losses")
_QUERRY = "M. R. Querry, Optical constants, Contractor Report CRDC-CR-85034 (1985)"

# name: (eta, k, source). Tabulated values, straight lines between them, at the three wavelengths.
METALS: dict[str, tuple[tuple[float, ...], tuple[float, ...], str]] = {
    "aluminium": ((1.34, 0.994, 0.686), (7.351, 6.57, 5.635), "A. D. Rakic, Appl. Opt. 34, 4755 (1995)"),
    "brass": ((0.4505, 0.538, 0.947), (3.39, 2.716, 1.92), f"{_QUERRY}, 70 % copper, 30 % zinc"),
    "chromium": ((3.173, 3.146, 2.456), (3.3, 3.33, 3.21), _TRANSITION),
    "cobalt": ((2.187, 2.039, 1.789), (4.101, 3.8, 3.371), _TRANSITION),
    "commercial-bronze": ((0.336, 0.5555, 0.948), (3.091, 2.372, 2.012),
                          f"{_QUERRY}, 90 % copper, 10 % zinc: the alloy that trade calls bronze, without tin"),
    "copper": ((0.3207, 1.041, 1.247), (3.179, 2.581, 2.456), _NOBLE),
    "gold": ((0.2141, 0.4547, 1.332), (3.251, 2.406, 1.869), _NOBLE),
    "iron": ((2.883, 2.937, 2.646), (3.047, 2.927, 2.805), _TRANSITION),
    "nickel": ((1.988, 1.91, 1.765), (4.007, 3.583, 3.048), _TRANSITION),
    "palladium": ((1.746, 1.63, 1.445), (4.199, 3.817, 3.351), _TRANSITION),
    "platinum": ((2.268, 2.072, 1.879), (4.079, 3.687, 3.223),
                 "A. D. Rakic, A. B. Djurisic, J. M. Elazar and M. L. Majewski, Appl. Opt. 37, 5271 (1998), "
                 "Brendel-Bormann fit"),
    "silver": ((0.05948, 0.0587, 0.04688), (4.137, 3.552, 2.803), _NOBLE),
    "stainless-steel": ((2.1, 1.889, 1.561), (3.372, 3.155, 2.839),
                        "B. Karlsson and C. G. Ribbing, J. Appl. Phys. 53, 6340 (1982), ferritic steel with "
                        "13.5 % chromium, read off a figure"),
    "titanium": ((2.666, 2.526, 2.305), (3.712, 3.411, 3.082), _TRANSITION),
    "zinc": ((1.121, 0.9162, 0.7128), (5.567, 4.928, 4.16), _WERNER),
}


def names() -> list[str]:
    """The metals that conductor() knows."""
    return sorted(METALS)


def conductor(name: str, alpha: float = 0.0, distribution: str = "ggx") -> Conductor:
    """A metal of the table, at 615, 545 and 465 nm, in air. Raises UnknownName, a KeyError and StackError."""
    eta, k, _ = _entry(name)
    return Conductor(eta, k, alpha, distribution)


def source(name: str) -> str:
    """Where a metal's indices come from. Raises UnknownName, a KeyError and StackError."""
    return f"{_entry(name)[2]}; at 615, 545 and 465 nm, interpolated"


def _entry(name: str):
    if not isinstance(name, str) or name not in METALS:
        raise unknown("metal", name, names())
    return METALS[name]


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
