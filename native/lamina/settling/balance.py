# SPDX-License-Identifier: GPL-3.0-or-later
"""Mass balance: grains traced from above, an independent check of the amount of dust on a surface."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

GRAINS = 1 << 18
LIFT = 0.01  # height above the surface of the rectangle that grains pass through; half of the surface's diagonal is 1
_STREAM = 0x6772_6169_6E73_0000  # separate random numbers


@dataclass(frozen=True)
class FallFrame:
    """Directions of a fall: up and two horizontal ones, orthonormal, and the wind along those two relative to the
    fall."""

    up: np.ndarray
    across1: np.ndarray
    across2: np.ndarray
    wind1: float
    wind2: float
    spread: float

    @classmethod
    def of(cls, gravity, wind, spread: float) -> FallFrame:
        down = np.asarray(gravity, np.float64)
        up = -down / np.linalg.norm(down)
        across1 = np.zeros(3)
        across1[int(np.argmin(np.abs(up)))] = 1.0
        across1 -= up * (up @ across1)
        across1 /= np.linalg.norm(across1)
        across2 = np.cross(up, across1)
        wind = np.asarray(wind, np.float64)
        return cls(up, across1, across2, float(wind @ across1), float(wind @ across2), spread)

    def core(self, layer):
        """The core's Fall."""
        return layer.Fall(self.up, self.across1, self.across2, self.wind1, self.wind2, math.sin(self.spread))


@dataclass(frozen=True)
class Forward:
    """Numbers of grains as areas in m^2 of an open horizontal plane: all grains, those on the front and on the back of
    the surface's faces, those on each occluder, and those on nothing; and the standard errors for the front and for
    either side."""

    launched: float
    front: float
    back: float
    stopped_by: tuple[float, ...]
    missed: float
    front_stderr: float
    both_stderr: float
    grains: int


@dataclass(frozen=True)
class Window:
    """The rectangle above a surface that grains pass through. corner, edge1, edge2: (3,) each, in the surface's frame;
    area: in m^2."""

    corner: np.ndarray
    edge1: np.ndarray
    edge2: np.ndarray
    area: float


def window_over(surface: np.ndarray, fall: FallFrame, scale: float) -> Window:
    """`surface`: (n, 3) vertices in its frame, whose unit is `scale` metres.

    The rectangle lies above the surface's highest point. It is so large that each grain that can touch the surface's
    bounding box passes through it."""
    (low_up, top), (low1, high1), (low2, high2) = (_extent(surface, axis) for axis in
                                                  (fall.up, fall.across1, fall.across2))
    top += LIFT
    slope, depth = math.tan(fall.spread), top - low_up
    low1, high1 = _widened(low1, high1, -fall.wind1, slope, depth)
    low2, high2 = _widened(low2, high2, -fall.wind2, slope, depth)
    corner = top * fall.up + low1 * fall.across1 + low2 * fall.across2
    return Window(corner, (high1 - low1) * fall.across1, (high2 - low2) * fall.across2,
                  (high1 - low1) * (high2 - low2) * scale * scale)


def trace(scene, core_fall, window: Window, occluders: int, seed: int, grains: int = GRAINS) -> Forward:
    """Grains through the window, in a scene of the surface and after it that number of occluders."""
    area = window.area
    if not area > 0.0:
        return Forward(0.0, 0.0, 0.0, (0.0,) * occluders, 0.0, 0.0, 0.0, 0)
    counts = scene.grains(core_fall, window.corner, window.edge1, window.edge2, grains, seed ^ _STREAM)
    stopped_by = tuple(area * count / grains for count in counts[2][1:])
    front, back, missed = (area * counts[k] / grains for k in (0, 1, 3))

    def stderr(count: int) -> float:
        share = count / grains
        return area * math.sqrt(share * (1.0 - share) / grains)

    return Forward(area, front, back, stopped_by, missed, stderr(counts[0]), stderr(counts[0] + counts[1]), grains)


def _extent(vertices: np.ndarray, axis: np.ndarray) -> tuple[float, float]:
    along = vertices @ axis.astype(vertices.dtype)
    return float(along.min()), float(along.max())


def _widened(low: float, high: float, drift: float, slope: float, depth: float) -> tuple[float, float]:
    return low + min(0.0, (drift - slope) * depth), high + max(0.0, (drift + slope) * depth)
