# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves over the view angle: directional albedos, and the errors of a table."""

from __future__ import annotations

import numpy as np

from ..baking.report.comparison import Comparison
from ..baking.table.lut import Lut
from ..common.errors import ArgumentError, quoted
from .subjects import AnySubject, albedo, colours, is_sheet, label_of, new_axes, style_of, subject_of

ANGLES = np.linspace(0.0, 89.0, 90)  # degrees
WORDS = {"reflect": "reflected", "transmit": "transmitted"}


def albedos(what: AnySubject, *more: AnySubject, side: str = "top", ax=None):
    """Draws the reflectance, and for sheets the transmittance (thin lines), over the view angle in degrees, mirrored
    and unscattered light included.

    `what` and `more`: solved stacks (solid), lookup tables (dashed) or stacks. `side`: of the viewer. `ax`: axes of
    matplotlib, by default new ones, which are returned. Raises ExtraMissing without matplotlib, and ArgumentError."""
    subjects = [subject_of(one) for one in (what, *more)]
    ax = new_axes(ax)
    mu = np.cos(np.radians(ANGLES))
    for subject in subjects:
        paths = ("reflect", "transmit") if is_sheet(subject) else ("reflect",)
        for path, width in zip(paths, (1.6, 0.8), strict=False):
            found = albedo(subject, mu, path, side)
            for index, colour in enumerate(colours(found.shape[1])):
                ax.plot(ANGLES, found[:, index], style_of(subject), color=colour, linewidth=width,
                        label=f"{label_of(subject)}, {WORDS[path]}" if index == 0 else None)
    ax.set_xlabel("view angle (degrees)")
    ax.set_ylabel("directional albedo")
    ax.set_ylim(bottom=0.0)
    ax.legend(fontsize="small")
    return ax


def errors(what: Lut | Comparison, ax=None):
    """Draws the error of each slice of a table over the view angle: the mean over thicknesses and sides (line), and
    the range (band), for each channel. `what`: a Comparison of Lut.compare, or a table, which is compared with its own
    stack. `ax`: axes of matplotlib, by default new ones, which are returned. Raises ExtraMissing without matplotlib,
    and ArgumentError."""
    if not isinstance(what, Lut | Comparison):
        raise ArgumentError(f"what = {quoted(what)}: must be a Lut or a Comparison")
    ax = new_axes(ax)
    compared = what.compare() if isinstance(what, Lut) else what
    angles = np.degrees(compared.angles)
    for (kind, found), style in zip(compared.errors.items(), ("-", "--"), strict=False):
        by_channel = np.nan_to_num(np.moveaxis(found, 2, 0).reshape(found.shape[2], -1, len(angles)))
        for number, (one, colour) in enumerate(zip(by_channel, colours(len(by_channel)), strict=True)):
            ax.plot(angles, 100.0 * one.mean(axis=0), style, color=colour, label=None if number else kind)
            ax.fill_between(angles, 100.0 * one.min(axis=0), 100.0 * one.max(axis=0), color=colour, alpha=0.15,
                            linewidth=0)
    ax.set_xlabel("view angle (degrees)")
    ax.set_ylabel("relative error of the slice (%)")
    ax.set_ylim(bottom=0.0)
    ax.legend(fontsize="small")
    return ax
