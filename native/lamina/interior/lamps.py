# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps at infinity."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..common.arguments import check_number, finite_array
from ..common.errors import ArgumentError, quoted

LEAST_DISC = math.radians(1.0)  # behind a smooth boundary, paths must hit the lamp's disc by chance


@dataclass(frozen=True)
class Lamp:
    """A distant lamp with irradiance 1 on a plane perpendicular to its direction. `towards`: direction to the lamp, any
    length above 0. `angle`: angular radius of the lamp's disc in radians, [0, 1]. Raises ArgumentError."""

    towards: Sequence[float]
    angle: float = 0.0

    def __post_init__(self):
        towards = finite_array(self.towards, "towards")
        length = float(np.linalg.norm(towards)) if towards.shape == (3,) else 0.0
        if not length > 0.0:
            raise ArgumentError(f"towards = {quoted(self.towards)}: must be three numbers, not all 0")
        object.__setattr__(self, "towards", tuple(map(float, towards / length)))
        angle = check_number(self.angle, "angle", "must lie in [0, 1]", lambda value: 0.0 <= value <= 1.0)
        object.__setattr__(self, "angle", angle)
