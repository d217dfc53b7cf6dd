# SPDX-License-Identifier: GPL-3.0-or-later
"""Small pictures for notebooks, as SVG."""

from __future__ import annotations

import html
from collections.abc import Sequence

import numpy as np

from .srgb import srgb


def colour(linear: Sequence[float]) -> str:
    """The CSS colour of linear Rec. 709 values, one or three, clipped to [0, 1]."""
    values = [linear[0]] * 3 if len(linear) != 3 else linear
    return "#" + "".join(f"{round(255 * value):02x}" for value in srgb(values).tolist())


def picture(width: float, height: float, parts: Sequence[str], title: str) -> str:
    """An SVG of these elements; `title` is read out in place of the picture."""
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}" height="{height:g}" '
            f'viewBox="0 0 {width:g} {height:g}" role="img" style="background:#fff" font-family="sans-serif" '
            f'font-size="12"><title>{html.escape(title)}</title>{"".join(parts)}</svg>')


def box(x: float, y: float, width: float, height: float, fill: str, stroke: str = "none") -> str:
    return (f'<rect x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}" fill="{fill}" '
            f'stroke="{stroke}"/>')


def text(x: float, y: float, words: str, fill: str = "#202020", anchor: str = "start") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" fill="{fill}" text-anchor="{anchor}">{html.escape(words)}</text>'


def line(points: np.ndarray, stroke: str, width: float = 1.5, dashes: str = "") -> str:
    """A line through points, shape (count, 2)."""
    places = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    dashed = f' stroke-dasharray="{dashes}"' if dashes else ""
    return f'<polyline points="{places}" fill="none" stroke="{stroke}" stroke-width="{width:g}"{dashed}/>'
