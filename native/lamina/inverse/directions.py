# SPDX-License-Identifier: GPL-3.0-or-later
"""Lists of directions with values of a BRDF, and a choice of some of them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


@dataclass(frozen=True, eq=False)
class Directions:
    """mu_o, mu_i, dphi: shape (count,), see lamina.measurements.Brdf. values: 1/sr, shape (count, channels)."""

    mu_o: np.ndarray
    mu_i: np.ndarray
    dphi: np.ndarray
    values: np.ndarray

    @classmethod
    def of_vectors(cls, wi: np.ndarray, wo: np.ndarray, values: np.ndarray) -> Directions:
        """Of unit vectors from the surface to the light and to the viewer, shape (count, 3), the normal along z; those
        below the horizon are left out."""
        above = (wi[:, 2] > 0.0) & (wo[:, 2] > 0.0)
        wi, wo, values = wi[above], wo[above], values[above]
        # dphi is 0 when light keeps its azimuth: it then leaves opposite to the direction where it came from.
        cross = wi[:, 1] * wo[:, 0] - wi[:, 0] * wo[:, 1]
        dot = -wi[:, 0] * wo[:, 0] - wi[:, 1] * wo[:, 1]
        return cls(np.minimum(wo[:, 2], 1.0), np.minimum(wi[:, 2], 1.0), np.abs(np.arctan2(cross, dot)), values)

    def where(self, chosen: np.ndarray) -> Directions:
        """The directions that a mask or a list of indices chooses."""
        return Directions(*(getattr(self, name)[chosen] for name in ("mu_o", "mu_i", "dphi", "values")))

    def some(self, count: int, grazing: float) -> Directions:
        """`count` of the directions with angles up to `grazing` degrees, spread evenly over the list, the same for
        each call."""
        least = math.cos(math.radians(grazing))
        able = np.flatnonzero((self.mu_o >= least) & (self.mu_i >= least))
        if len(able) > count:
            # Multiples of the golden ratio, so that no axis of the list's grid is met in step
            places = np.sort(np.unique((np.arange(count) * GOLDEN % 1.0 * len(able)).astype(int)))
            able = able[places]
        return self.where(able)
