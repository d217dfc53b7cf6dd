# SPDX-License-Identifier: GPL-3.0-or-later
"""A lookup table as a picture, and a table beside its stack."""

from __future__ import annotations

import numpy as np

from ..baking.table.lut import Lut
from ..common.arguments import check_choice, check_kind
from ..material.any_stack import AnyStack, as_stack
from ..solver.solve import solve
from .curves import albedos, errors
from .lobes import lobes
from .subjects import new_axes, pyplot


def table(lut: Lut, side: str = "top", ax=None):
    """Draws the weights of a table: one strip of thicknesses (upwards) by view angles for each closure, the square root
    of the weight relative to the largest of all as red, green and blue. `side`: of the viewer. `ax`: axes of
    matplotlib, by default new ones, which are returned. Raises ExtraMissing without matplotlib, and ArgumentError."""
    lut = check_kind(lut, "lut", Lut, "a Lut")
    sides = lut.header["sides"]
    index = sides.index(check_choice(side, "side", sides, " or ".join(map(repr, sides))))
    ax = new_axes(ax)
    strips = lut.weights[index]
    closures, rows, columns, _ = strips.shape
    picture = np.sqrt(strips / max(float(strips.max()), 1e-30)).reshape(-1, columns, 3)
    ax.imshow(picture, origin="lower", aspect="auto", interpolation="nearest", extent=(0.0, 90.0, 0.0, closures))
    ax.set_yticks(np.arange(closures) + 0.5, lut.closures, fontsize="small")
    for line in range(1, closures):
        ax.axhline(line, color="white", linewidth=0.5)
    ax.set_xlabel("view angle (degrees)")
    ax.set_title(f"{rows} thicknesses per closure" if rows > 1 else "weights", fontsize="medium")
    return ax


def compare(lut: Lut, stack: AnyStack | None = None, mu_o=(1.0, 0.5)):
    """A figure with a table beside the exact stack, by default the one that was baked: lobes at the view cosines
    `mu_o`, albedos, errors by view, and the table. Returns the figure. Raises ExtraMissing without matplotlib,
    ArgumentError, and what Lut.compare raises."""
    lut = check_kind(lut, "lut", Lut, "a Lut")
    plt = pyplot()
    given = lut.stack if stack is None else as_stack(stack)
    compared, exact = lut.compare(given), solve(given)
    figure = plt.figure(figsize=(11, 8), layout="constrained")
    lobes(exact, lut, mu_o=mu_o, ax=figure.add_subplot(2, 2, 1, projection="polar"))
    albedos(exact, lut, ax=figure.add_subplot(2, 2, 2))
    errors(compared, ax=figure.add_subplot(2, 2, 3))
    table(lut, ax=figure.add_subplot(2, 2, 4))
    return figure
