# SPDX-License-Identifier: GPL-3.0-or-later
"""How dust falls and what stays, checked."""

from __future__ import annotations

import math
import numbers
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..common.errors import DustError
from .substances import extinction_of

MOST_SPREAD = 1.5  # radians: grains that fall level never land


@dataclass(frozen=True)
class Settling:
    """How dust falls and what stays. Angles in radians, lengths in metres. Raises DustError.

    amount: optical thickness on an open horizontal plate, [0, 1000]; 1 if `grams` is not given.
    grams: areal mass in g/m^2 instead of the amount, [0, 1e6]; times `extinction` it is the optical thickness.
    extinction: of mass, in m^2/g, (0, 1000], or the id of a dust in `lamina.dust_materials` (green channel).
    time: how long it falls, in units of the time in which `amount` does, [0, 1e6].
    gravity: the direction down, of any length but 0.
    spread: half-angle of the cone from which grains fall, evenly over solid angle, [0, MOST_SPREAD].
    wind: velocity of the wind over that of the fall, metres per metre; its part along gravity is left out. Of length
        1 it tilts the fall by 45 degrees. Length at most 20.
    repose: slope at which half of the grains slide off, [0, pi]; pi: all stay wherever they touch.
    repose_width: range of slopes, centred on it, over which that sets in, [0, pi].
    concavity: how much of what would slide holds where nothing is open above, [0, 1]: a share concavity * (1 -
        exposure) stays; exposure is the cosine-weighted part of the hemisphere that is open within `reach`.
    reach: distance up to which neighbours shelter, > 0; None: 5 % of the diagonal of the surface's box.
    coverage: share of the surface, [0, 1], on which dust is left in soft-edged patches; elsewhere it is wiped off.
    patch: size of those patches, > 0; None: 10 % of the diagonal.
    two_sided: dust lies on either side of a face (leaves, cloth, normals not to be trusted): on both as a sum, and on
        the back alone. Otherwise only on the side that the normal points to. Any face stops grains, whichever side
        they meet.
    rays: rays a point, 1 to 65536. From two on, what arrives is a ratio of sums over rays, exact where all is open.
        Where a slope is partly hidden, the mean of such ratios over many seeds is off: on slopes of 40 to 80 degrees
        with one half of the sky hidden by at most .004 of the amount with 2 rays, .002 with 4, .0004 with 8. A single
        ray has no such bias, but is noisy on open slopes too."""

    amount: float | None = None
    grams: float | None = None
    extinction: float | str = "dust-saharan-1.7um"
    time: float = 1.0
    gravity: Sequence[float] = (0.0, 0.0, -1.0)
    spread: float = math.radians(35.0)
    wind: Sequence[float] = (0.0, 0.0, 0.0)
    repose: float = math.radians(45.0)
    repose_width: float = math.radians(20.0)
    concavity: float = 0.5
    reach: float | None = None
    coverage: float = 1.0
    patch: float | None = None
    two_sided: bool = False
    rays: int = 256

    def __post_init__(self):
        if self.amount is not None and self.grams is not None:
            raise DustError("settling has both amount and grams: must have one of them")
        for name, low, high in (("amount", 0.0, 1e3), ("grams", 0.0, 1e6), ("time", 0.0, 1e6),
                                ("spread", 0.0, MOST_SPREAD), ("repose", 0.0, math.pi),
                                ("repose_width", 0.0, math.pi), ("concavity", 0.0, 1.0), ("reach", 1e-12, 1e12),
                                ("coverage", 0.0, 1.0), ("patch", 1e-12, 1e12)):
            value = getattr(self, name)
            if value is None and name in ("amount", "grams", "reach", "patch"):
                continue
            if not _is_number(value) or not low <= value <= high:
                raise DustError(f"settling.{name} = {value!r}: must lie in [{low:g}, {high:g}]")
        if isinstance(self.rays, bool) or not isinstance(self.rays, int) or not 1 <= self.rays <= 65536:
            raise DustError(f"settling.rays = {self.rays!r}: must be a whole number from 1 to 65536")
        extinction_of(self.extinction)
        down = _vector(self.gravity, "settling.gravity")
        if not np.linalg.norm(down) > 0.0:
            raise DustError(f"settling.gravity = {tuple(self.gravity)!r}: must not be zero")
        if np.linalg.norm(_vector(self.wind, "settling.wind")) > 20.0:
            raise DustError(f"settling.wind = {tuple(self.wind)!r}: must be at most 20 long")

    @property
    def tau(self) -> float:
        """Optical thickness on an open horizontal plate."""
        if self.grams is not None:
            return self.grams * extinction_of(self.extinction) * self.time
        return (1.0 if self.amount is None else self.amount) * self.time


def _is_number(value) -> bool:
    return isinstance(value, numbers.Real) and not isinstance(value, bool) and math.isfinite(value)


def _vector(value, name: str) -> np.ndarray:
    items = list(value) if isinstance(value, Sequence | np.ndarray) and not isinstance(value, str) else []
    if len(items) != 3 or not all(_is_number(item) and abs(item) <= 1e9 for item in items):
        raise DustError(f"{name} = {value!r}: must be three numbers")
    return np.array(items, np.float64)
