# SPDX-License-Identifier: GPL-3.0-or-later
"""What a plot shows: a solved stack or a lookup table, by the same calls; and the axes on which it is drawn."""

from __future__ import annotations

import os

import numpy as np

from ..baking.report.lobe_picture import COLOURS, GREY
from ..baking.table.lut import Lut
from ..common.arguments import check_choice
from ..common.errors import ArgumentError, quoted
from ..common.extras import require
from ..material.any_stack import as_stack
from ..material.stack import Stack
from ..solver.solve import ScatteringFunction, solve

Subject = ScatteringFunction | Lut
AnySubject = Subject | Stack | str | os.PathLike


def subject_of(given: AnySubject) -> Subject:
    """The solved stack or table that `given` stands for; a stack is solved. Raises ArgumentError and what
    lamina.solve raises."""
    if isinstance(given, ScatteringFunction | Lut):
        return given
    if not isinstance(given, Stack | str | os.PathLike):
        raise ArgumentError(f"what = {quoted(given)}: must be a ScatteringFunction, a Lut, or a stack")
    return solve(as_stack(given))


def is_sheet(subject: Subject) -> bool:
    return subject.stack.base is None


def values(subject: Subject, mu_o, mu_i, dphi, path: str, side: str) -> np.ndarray:
    """BRDF or BTDF in 1/sr, shape: broadcast + (channels,)."""
    if isinstance(subject, Lut):
        return subject.evaluate(mu_o, mu_i, dphi, path=path, side=side)[..., :subject.stack.table_channels]
    check_choice(path, "path", ("reflect", "transmit"))
    return (subject.brdf if path == "reflect" else subject.btdf)(mu_o, mu_i, dphi, side)


def albedo(subject: Subject, mu, path: str, side: str) -> np.ndarray:
    """Directional albedo, shape: that of mu + (channels,)."""
    found = (subject.reflectance if path == "reflect" else subject.transmittance)(mu, side)
    return found[..., :subject.stack.table_channels] if isinstance(subject, Lut) else found


def label_of(subject: Subject) -> str:
    return "fitted" if isinstance(subject, Lut) else "exact"


def style_of(subject: Subject) -> str:
    return "--" if isinstance(subject, Lut) else "-"


def colours(channels: int) -> tuple[str, ...]:
    """A colour for each channel."""
    if channels == 3:
        return COLOURS
    return (GREY,) if channels == 1 else tuple(f"C{number % 10}" for number in range(channels))


def pyplot():
    """matplotlib.pyplot. Raises ExtraMissing."""
    return require("matplotlib.pyplot", "lamina.plot")


def new_axes(given, polar: bool = False):
    """`given`, or axes of a new figure. Raises ExtraMissing, and ArgumentError for axes of the wrong kind."""
    plt = pyplot()
    if given is None:
        return plt.subplots(subplot_kw={"projection": "polar"} if polar else None, layout="constrained")[1]
    if not isinstance(given, plt.Axes) or (given.name == "polar") != polar:
        raise ArgumentError(f"ax = {quoted(given)}: must be {'polar' if polar else 'rectangular'} axes of matplotlib")
    return given
