# SPDX-License-Identifier: GPL-3.0-or-later
"""Lobes in polar form: the light that a view receives, by the direction from which it comes."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence

import numpy as np

from ..baking.report.lobe_picture import lobe
from ..common.arguments import cosines, finite_list
from ..common.errors import ArgumentError
from .subjects import AnySubject, Subject, colours, is_sheet, label_of, new_axes, style_of, subject_of, values


def lobes(what: AnySubject, *more: AnySubject, mu_o: float | Sequence[float] = 0.7, channel: int | None = None,
          side: str = "top", ax=None):
    """Draws cosine-weighted lobes (1/sr) in the plane of incidence for the view cosines `mu_o`, in (0, 1].

    `what` and `more`: solved stacks (solid lines), lookup tables (dashed lines) or stacks, which are solved; give a
    solved stack and its table to see exact beside fitted. The angle is that of the light with the normal: 0 along the
    normal, right of it the light that comes from the mirror direction's side, below the horizon transmitted light of a
    sheet. `channel`: the only one drawn. `side`: of the viewer. `ax`: polar axes of matplotlib, by default new ones,
    which are returned. Directions within 3 degrees of the horizon are left out: there the Hair closures of a sheet's
    table have a pole for a view along the normal. For oblique views this pole, which Cycles has too, is drawn as a thin
    spike. Specular and unscattered light has no finite value and is not drawn. Raises ExtraMissing without matplotlib,
    and ArgumentError."""
    subjects = [subject_of(one) for one in (what, *more)]
    views = cosines(finite_list(mu_o, "mu_o"), "mu_o")
    if not views.size:
        raise ArgumentError("mu_o = []: must hold a cosine")
    ax = new_axes(ax, polar=True)
    for subject in subjects:
        for mu in views:
            angle, value = lobe(functools.partial(values, subject), is_sheet(subject), float(mu), side)
            _draw(ax, subject, float(mu), angle, value, channel, len(views) > 1)
    ax.set_theta_zero_location("N")
    ax.set_theta_direction(-1)
    if not any(map(is_sheet, subjects)):
        ax.set_thetamin(-90)
        ax.set_thetamax(90)
    ax.set_yticks(ax.get_yticks()[::3])
    ax.set_xlabel("angle of the light; value times cosine in 1/sr")
    ax.legend(fontsize="small", loc="lower center" if any(map(is_sheet, subjects)) else "upper right")
    return ax


def _draw(ax, subject: Subject, mu: float, angle: np.ndarray, value: np.ndarray, channel: int | None,
          several: bool) -> None:
    channels = value.shape[1]
    if channel is not None and channel not in range(channels):
        raise ArgumentError(f"channel = {channel}: must be a whole number from 0 to {channels - 1}")
    for index, colour in enumerate(colours(channels)):
        if channel in (None, index):
            ax.plot(angle, value[:, index], style_of(subject), color=colour, linewidth=1.2,
                    alpha=0.4 + 0.6 * mu if several else 1.0,
                    label=f"{label_of(subject)}, {math.degrees(math.acos(mu)):.0f}°" if index == (channel or 0)
                    else None)
