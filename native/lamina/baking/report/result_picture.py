# SPDX-License-Identifier: GPL-3.0-or-later
"""Small pictures of a bake's result, drawn from result_curves with numpy alone: polar lobes of a view, the albedo over
the view angle, and a ball in a studio.

Pictures are float32, (size, size, 4), bottom row first, for a display without color management: colors in sRGB, not
multiplied by alpha. The background is transparent. `ink` is the color of lines, such as that of the text around the
picture."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ...common.srgb import srgb
from . import lit_ball

MARGIN = 0.04  # of a picture's size, on each side
LINE, THIN = 0.014, 0.008  # widths of lines, as shares of a picture's size; at least a pixel
EXACT = (0.30, 0.56, 0.94)  # color of the exact lobe; on dark and on light grounds
CHANNELS = ((0.93, 0.30, 0.28), (0.28, 0.72, 0.33), (0.33, 0.52, 0.97))


def lobe_picture(curves: dict, view: int, size: int = 160, ink: Sequence[float] = (0.9, 0.9, 0.9)) -> np.ndarray:
    """The light scattered in the plane of incidence for one of the views. The distance from the center is the square
    root of the light, relative to the exact lobe's largest value: filled for the exact function, a line for the fitted
    closures. The viewer, a dot on the rim, is on the left. Straight lines are specular reflection and unscattered
    transmission. Below the surface are transmitted lobes, or for a stack on a base the color seen from there."""
    canvas = _Canvas(size)
    radius, middle = (0.5 - MARGIN) * size, 0.5 * size
    angle, distance = canvas.polar(middle, middle)
    lights = np.radians(curves["lights"])
    is_sheet = curves["through_exact"] is not None
    kinds = (("exact", "fitted", 1.0),) + ((("through_exact", "through_fitted", -1.0),) if is_sheet else ())
    largest = max(max(curves[name][view]) for name, _, _ in kinds)

    # The color of a stack on a base, seen from the view, below the surface
    if not is_sheet:
        color = srgb(_at_angle(curves["reflectance"], curves["angles"], curves["views"][view]))
        canvas.paint(color, _edge(radius - distance) * _edge(middle - canvas.y))

    # Lobes: `lights` are angles from the normal, positive to the right
    for exact, fitted, up in kinds:
        reach = radius * _lengths(curves[exact][view], largest)
        elevation = np.arctan2(np.cos(angle), up * np.sin(angle))  # angle from the normal of this side
        side = _edge(up * (canvas.y - middle))
        canvas.paint(EXACT, 0.75 * side * _edge(np.interp(elevation, lights, reach) - distance))
        line = radius * _lengths(curves[fitted][view], largest)
        canvas.stroke(middle + line * np.sin(lights), middle + up * line * np.cos(lights), ink, LINE * size)
    for name, up in (("mirrored", 1.0), ("straight", -1.0)):
        if curves[name][view] > 1e-3:
            _ray(canvas, middle, up, math.radians(curves["views"][view]), radius, EXACT, size)

    # The rim, the surface and the viewer
    rim = np.linspace(0.0, 2.0 * math.pi, 200)
    canvas.stroke(middle + radius * np.cos(rim), middle + radius * np.sin(rim), ink, THIN * size, 0.35)
    canvas.stroke([MARGIN * size, (1.0 - MARGIN) * size], [middle, middle], ink, THIN * size, 0.8)
    seen = math.radians(curves["views"][view])
    x, y = middle - radius * math.sin(seen), middle + radius * math.cos(seen)
    canvas.stroke([x, middle], [y, middle], ink, THIN * size, 0.35)
    canvas.paint(ink, _edge(0.035 * size - np.hypot(canvas.x - x, canvas.y - y)))
    return canvas.pixels()


def albedo_picture(curves: dict, size: int = 160, ink: Sequence[float] = (0.9, 0.9, 0.9)) -> np.ndarray:
    """Reflectance over the view angle: 0 degrees on the left, 90 on the right; 0 at the bottom, 1 at the top. A line
    for each channel; of a sheet, thin lines for the transmittance."""
    canvas = _Canvas(size)
    low, high = MARGIN * size, (1.0 - MARGIN) * size

    def place(share):
        return low + (high - low) * np.clip(share, 0.0, 1.0)

    for share in (0.0, 0.5, 1.0):
        canvas.stroke([low, high], [place(share)] * 2, ink, THIN * size, 0.8 if share == 0.0 else 0.25)
    for angle in (0.0, 30.0, 60.0, 90.0):
        canvas.stroke([place(angle / 90.0)] * 2, [low, high], ink, THIN * size, 0.8 if angle == 0.0 else 0.25)
    across = place(np.asarray(curves["angles"]) / 90.0)
    for name, width in (("transmittance", THIN), ("reflectance", 1.6 * LINE)):
        values = np.asarray(curves[name] if curves[name] is not None else np.zeros((0, 3)))
        if not len(values):
            continue
        if np.ptp(values, axis=1).max() < 2e-3:
            canvas.stroke(across, place(values[:, 0]), ink, width * size)
            continue
        for channel, color in enumerate(CHANNELS):
            canvas.stroke(across, place(values[:, channel]), color, width * size)
    return canvas.pixels()


def ball_picture(curves: dict, size: int = 160, ink: Sequence[float] = (0.9, 0.9, 0.9)) -> np.ndarray:
    """A ball of the material in the studio of lit_ball."""
    canvas = _Canvas(size)
    radius, middle = (0.5 - MARGIN) * size, 0.5 * size
    azimuth, distance = canvas.polar(middle, middle)
    angle = np.arcsin(np.clip(distance / radius, 0.0, 1.0))
    colors = lit_ball.colors_at(curves["ball"], curves["ball_mirrored"], angle, azimuth)
    canvas.paint(srgb(np.clip(colors, 0.0, 1.0)), _edge(radius - distance))
    canvas.paint(ink, 0.5 * _edge(0.5 * THIN * size - np.abs(distance - radius)))
    return canvas.pixels()


class _Canvas:
    """Colors multiplied by alpha, painted one over the other. x, y: of the pixels' centers, from the lower left."""

    def __init__(self, size: int):
        self.size = size
        self.y, self.x = np.mgrid[0:size, 0:size] + 0.5
        self._colors, self._alpha = np.zeros((size, size, 3)), np.zeros((size, size))

    def polar(self, x: float, y: float) -> tuple[np.ndarray, np.ndarray]:
        """(angle from the right, anticlockwise; distance) of the pixels from a point."""
        return np.arctan2(self.y - y, self.x - x), np.hypot(self.x - x, self.y - y)

    def paint(self, color, coverage: np.ndarray) -> None:
        """Paint a color, or one for each pixel, over what is there."""
        coverage = np.clip(coverage, 0.0, 1.0)
        self._colors = self._colors * (1.0 - coverage[..., None]) + np.asarray(color) * coverage[..., None]
        self._alpha = self._alpha * (1.0 - coverage) + coverage

    def stroke(self, x, y, color, width: float, opacity: float = 1.0) -> None:
        """A line through points, with round joints: the union of discs at every half pixel."""
        x, y = np.asarray(x, float), np.asarray(y, float)
        along = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
        steps = np.linspace(0.0, along[-1], int(2.0 * along[-1]) + 2)
        x, y = np.interp(steps, along, x), np.interp(steps, along, y)
        width = max(width, 1.0)
        reach = math.ceil(0.5 * width + 1.0)
        near = np.arange(-reach, reach + 1)
        columns, rows = (np.floor(values)[:, None, None].astype(int) + offset
                         for values, offset in ((x, near[None, None, :]), (y, near[None, :, None])))
        columns, rows = np.broadcast_arrays(columns, rows)
        disc = _edge(0.5 * width - np.hypot(columns + 0.5 - x[:, None, None], rows + 0.5 - y[:, None, None]))
        inside = (columns >= 0) & (columns < self.size) & (rows >= 0) & (rows < self.size)
        coverage = np.zeros((self.size, self.size))
        np.maximum.at(coverage, (rows[inside], columns[inside]), disc[inside])
        self.paint(color, opacity * coverage)

    def pixels(self) -> np.ndarray:
        alpha = np.maximum(self._alpha, 1e-9)[..., None]
        return np.concatenate([self._colors / alpha, self._alpha[..., None]], axis=2).astype(np.float32)


def _edge(inside: np.ndarray) -> np.ndarray:
    """Coverage of a pixel whose center lies this far inside an edge."""
    return np.clip(inside + 0.5, 0.0, 1.0)


def _lengths(values: Sequence[float], largest: float) -> np.ndarray:
    return np.sqrt(np.clip(np.asarray(values, float) / max(largest, 1e-12), 0.0, 1.0))


def _at_angle(values, angles, wanted) -> np.ndarray:
    """Values [angle][channel], linear between angles."""
    values = np.asarray(values, float)
    return np.stack([np.interp(wanted, angles, values[:, channel]) for channel in range(values.shape[1])], axis=-1)


def _ray(canvas: _Canvas, middle: float, up: float, angle: float, radius: float, color, size: int) -> None:
    canvas.stroke([middle, middle + radius * math.sin(angle)], [middle, middle + up * radius * math.cos(angle)],
                  color, 1.5 * LINE * size)
