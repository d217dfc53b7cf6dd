# SPDX-License-Identifier: GPL-3.0-or-later
"""A fit beside its measurements."""

from __future__ import annotations

import numpy as np

from ..common.arguments import check_kind
from ..inverse.result import Fit
from .subjects import colours, new_axes

MARKERS = "osDv^P*X"


def fitted(fit: Fit, ax=None):
    """Draws the measured values with their standard errors over the fitted values: one marker for each measurement, one
    colour for each channel, and the line where both are equal. `fit`: what lamina.fit returned. `ax`: axes of
    matplotlib, by default new ones, which are returned. Raises ExtraMissing without matplotlib, and ArgumentError."""
    fit = check_kind(fit, "fit", Fit, "what lamina.fit returned")
    ax = new_axes(ax)
    for number, (one, found, sigma) in enumerate(zip(fit.measurements, fit.fitted, fit.sigmas, strict=True)):
        for index, colour in enumerate(colours(one.channels)):
            ax.errorbar(found[:, index], one.values[:, index], sigma[:, index], color=colour,
                        fmt=MARKERS[number % len(MARKERS)], markersize=4, linewidth=0.8,
                        label=one.label if index == 0 else None)
    values = np.concatenate([part.ravel() for part in fit.fitted])
    ends = np.array([values.min(), values.max()])
    ax.plot(ends, ends, "k-", linewidth=0.8, zorder=0)
    if ends[0] > 0.0 and ends[1] > 30.0 * ends[0]:
        ax.set_xscale("log")
        ax.set_yscale("log")
    units = sorted({one.unit for one in fit.measurements})
    ax.set_xlabel(f"fitted ({', '.join(units)})")
    ax.set_ylabel(f"measured ({', '.join(units)})")
    ax.legend(fontsize="small")
    return ax
