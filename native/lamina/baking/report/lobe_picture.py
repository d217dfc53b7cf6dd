# SPDX-License-Identifier: GPL-3.0-or-later
"""Lobes in the plane of incidence, and a picture of a table's lobes."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ...common import svg
from ...kinds.table import closure_count
from ..fit.fitted_function import OTHER

STEPS = 181  # directions on each side of the horizon
# Least cosine of drawn light. Hair closures have a pole at the tangent, which is at the horizon for a view along the
# normal: in Cycles too, a thin spike with hardly any light.
LEAST_COSINE = 0.05
VIEWS = ((1.0, ""), (math.sqrt(0.5), "6 3"), (0.3, "2 2"))  # cosines and dashes
COLOURS = ("#c03028", "#2f8f2f", "#2f55c0")
GREY = "#303030"
RADIUS = 150.0


def lobe(values: Callable[..., np.ndarray], sheet: bool, mu_o: float, side: str) -> tuple[np.ndarray, np.ndarray]:
    """(angles of the light with the normal in radians, cosine-weighted values in 1/sr (angles, channels)) for a viewer
    on `side`, in the plane of incidence. Positive angles: the light keeps its azimuth. Light through a `sheet` follows
    after a gap of nan, at angles above pi / 2. `values(mu_o, mu_i, dphi, path, side)`: the BRDF or BTDF."""
    theta = np.linspace(-1.0, 1.0, STEPS) * math.acos(LEAST_COSINE)
    mu_i, dphi = np.cos(theta), np.where(theta >= 0.0, 0.0, np.pi)
    above = values(mu_o, mu_i, dphi, "reflect", side) * mu_i[:, None]
    if not sheet:
        return theta, above
    below = values(mu_o, mu_i, dphi, "transmit", OTHER[side]) * mu_i[:, None]
    gap = np.full((1, above.shape[1]), np.nan)
    return np.concatenate([theta, [np.nan], np.pi - theta]), np.concatenate([above, gap, below])


def lut_picture(lut) -> str:
    """The SVG of a table's lobes for views at 0, 45 and 73 degrees."""
    sheet, channels = lut.stack.base is None, lut.stack.table_channels

    def values(mu_o, mu_i, dphi, path, side):
        return lut.evaluate(mu_o, mu_i, dphi, path=path, side=side)[..., :channels]

    found = [(lobe(values, sheet, mu, "top"), dashes, mu) for mu, dashes in VIEWS]
    largest = max(float(np.nanmax(value)) for (_, value), _, _ in found) or 1.0
    width, height = 2.0 * RADIUS + 40.0, (2.0 if sheet else 1.0) * RADIUS + 60.0
    x0, y0 = 0.5 * width, RADIUS + 10.0
    parts = [svg.line(np.array([[0.0, y0], [width, y0]]), "#909090", 1.0)]
    for (angle, value), dashes, _ in found:
        for index in range(channels):
            length = RADIUS * value[:, index] / largest
            points = np.stack([x0 + length * np.sin(angle), y0 - length * np.cos(angle)], axis=1)
            for piece in np.split(points, np.flatnonzero(np.isnan(angle))):
                colour = COLOURS[index] if channels == 3 else GREY
                parts.append(svg.line(piece[~np.isnan(piece).any(axis=1)], colour, 1.3, dashes))
    views = ", ".join(f"{math.degrees(math.acos(mu)):.0f}°" for mu, _ in VIEWS)
    parts.append(svg.text(x0, height - 26.0, f"lobes at views {views}; largest {largest:.3g} / sr", anchor="middle"))
    parts.append(svg.text(x0, height - 8.0, f"{lut.header['quality']}, {closure_count(lut.header)} closures, fit error "
                                           f"{lut.header['report']['fit_error']:.2%}", anchor="middle"))
    return svg.picture(width, height, parts, repr(lut))
