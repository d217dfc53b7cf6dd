# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of the table of an anisotropic stack: azimuths of the viewer from the layer's tangent, over half a turn.

Facets look the same after half a turn. If all tangents lie along or across one another, the stack is also symmetric
about them: then a quarter turn is solved, and the second quarter mirrors the first."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...closures import shaped_lobes
from ...common.errors import StackError
from ...kinds.table import AZIMUTH_ROWS, SHAPE, TILT, Strip
from ...material.stack import Stack


@dataclass(frozen=True, eq=False)
class AzimuthRows:
    """`solved`: azimuths of the solved rows, from the tangent at the angle `tangent` in [0, pi) from that of the
    surface; `count`: of all rows; `mirrored`: true if the second quarter turn mirrors the first."""

    solved: np.ndarray
    count: int
    tangent: float
    mirrored: bool

    @classmethod
    def of(cls, stack: Stack, quality: str) -> AzimuthRows:
        count = AZIMUTH_ROWS[quality]
        tangent, mirrored = stack.tangent
        every = math.pi * np.arange(count) / (count - 1)
        return cls(every[:(count + 1) // 2] if mirrored else every[:-1], count, tangent, mirrored)

    def whole(self, strips: Sequence[Strip], values: np.ndarray) -> np.ndarray:
        """Values [side, strip, row, number, column] of all azimuths, from those of the solved ones. Rows are all
        thicknesses of the first azimuth, then those of the second, and so on."""
        sides, count, rows, *rest = values.shape
        blocks = values.reshape(sides, count, len(self.solved), -1, *rest)
        again = blocks[:, :, :1]
        if self.mirrored:
            again = blocks[:, :, -2::-1].copy()
            for index, strip in enumerate(strips):
                if strip.role in (SHAPE, TILT) and shaped_lobes.is_oriented(strip.closure):
                    again[:, index, :, :, 2 if strip.role == SHAPE else 1] *= -1.0  # a sin 2t, and l
        return np.concatenate([blocks, again], axis=2).reshape(sides, count, -1, *rest)


def require_oriented_table(stack: Stack) -> None:
    """Raises StackError for an anisotropic stack that no lookup table can hold."""
    needed = "for a bake with anisotropic facets"
    if stack.base is None:
        raise StackError(f"base = null: must be an opaque base {needed}")
    if stack.varying is not None:
        stack.require_on_top(stack.varying, "for a bake that varies it above anisotropic facets")
        stack.require_colours("a bake with a varying layer above anisotropic facets")
