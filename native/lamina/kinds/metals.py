# SPDX-License-Identifier: GPL-3.0-or-later
"""Metals: a table by name, and the complex index for two colours."""

from __future__ import annotations

import json
import math
from functools import cache, lru_cache
from importlib.resources import files

from .fields import Field, Option
from .panel import Item

GRAZING = math.cos(math.radians(82.0))  # of the angle of a metal's second colour (Hoffman 2019)
RANGES = (Field("mu", 0.0, 1.0, single=True), Field("eta", 0.0, 1e6, single=True), Field("k", 0.0, 1e6, single=True))
LEAST = 1e-9  # of the cosine and of eta, in place of 0 over 0


# Numbers in .blend files: a new metal is added at the end.
NAMES = ("aluminium", "brass", "chromium", "cobalt", "commercial-bronze", "copper", "gold", "iron", "nickel",
         "palladium", "platinum", "silver", "stainless-steel", "titanium", "zinc")
METAL = Option("metal", ("gold", *(name for name in NAMES if name != "gold")), "Metal", "The metal of this index",
               tuple(Item(name, name.replace("-", " ").capitalize(), "", number) for number, name in enumerate(NAMES)))


@cache
def table() -> dict:
    """{name: {facing, grazing, source}}: metals.json, which tools/metal_colours.py computes from published spectra."""
    return json.loads(files(__package__).joinpath("metals.json").read_text(encoding="utf-8"))


def reflectance(mu: float, eta: float, k: float) -> float:
    """Fresnel reflectance of a metal in air, of index eta + ik, for unpolarised light at cosine `mu`. Raises
    StackError unless `mu` lies in [0, 1], and `eta` and `k` in [0, 1e6]."""
    checked: list = [field.check(value, field.name) for field, value in zip(RANGES, (mu, eta, k), strict=True)]
    return _reflectance(max(checked[0], LEAST), max(checked[1], LEAST), checked[2])


def _reflectance(mu: float, eta: float, k: float) -> float:
    index = complex(eta, k) ** 2
    inside = (index - (1.0 - mu * mu)) ** 0.5
    across, along = (mu - inside) / (mu + inside), (index * mu - inside) / (index * mu + inside)
    return 0.5 * (abs(across) ** 2 + abs(along) ** 2)


def _extinction(facing: float, eta: float) -> float:
    """k of a metal of this reflectance at normal incidence (Gulbrandsen 2014)."""
    return math.sqrt(max(0.0, (facing * (eta + 1.0) ** 2 - (eta - 1.0) ** 2) / (1.0 - facing)))


@lru_cache(maxsize=1024)
def _ends(facing: float) -> tuple[float, float, float]:
    """(facing, least eta, largest eta): the range of eta with a real k, inside the range of a Conductor. A perfect
    mirror has no finite index, so a facing colour of 1 is lowered by 1e-6."""
    facing = min(facing, 1.0 - 1e-6)
    root = math.sqrt(facing)
    low, high = max((1.0 - root) / (1.0 + root), 1e-3), min((1.0 + root) / (1.0 - root), 100.0)
    if _extinction(facing, high) > 100.0:
        high = _bisect(lambda eta: _extinction(facing, eta) <= 100.0, low, high)
    return facing, low, high


def grazing_range(facing: float) -> tuple[float, float]:
    """(least, largest) reflectance at 82 degrees of metals of this facing colour; it falls as eta grows."""
    facing, low, high = _ends(facing)
    return _reflectance(GRAZING, high, _extinction(facing, high)), _reflectance(GRAZING, low, _extinction(facing, low))


@lru_cache(maxsize=4096)
def indices(facing: float, grazing: float) -> tuple[float, float]:
    """(eta, k) of the metal of these two reflectances, to 12 digits."""
    facing, low, high = _ends(facing)
    eta = _bisect(lambda eta: _reflectance(GRAZING, eta, _extinction(facing, eta)) >= grazing, low, high)
    return float(f"{eta:.12g}"), float(f"{_extinction(facing, eta):.12g}")


def _bisect(holds, low: float, high: float) -> float:
    """The largest number in [low, high] for which `holds(number)` is true. It must be true at `low`."""
    if holds(high):
        return high
    while high - low > 1e-15 * high:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low
