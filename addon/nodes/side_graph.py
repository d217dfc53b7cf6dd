# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust on two sides of a face: the thickness, and the side of the table, that each side of the face reads.

An opaque stack has its own thickness on either side. The table of a sheet has dust on the sheet's top only;
its bottom side is the view from below, with the dust behind the sheet. Where dust lies on back faces, the
sheet is turned over: back faces then read the table's top. This is right only if both sides of the clean
sheet are alike. Otherwise the table holds no such sheet, and dust on back faces is not shown.
"""

import numpy as np

from .expression import maximum, minimum

FRONT, BACK = "Thickness", "Thickness Back"
AS_FRONT = -1.0  # value of the back's input for no thickness of its own
MOST_LABEL = "at most the baked one"


def turns_over(lut):
    """True if a sheet may be turned over: its varying layer is on top, and the sides of the clean sheet are
    alike."""
    layers = lut.header["stack"]["layers"]
    if len(lut.header["sides"]) < 2 or layers[0]["kind"] != "medium" or not layers[0].get("varying"):
        return False
    top, bottom = np.asarray(lut.weights)[:, :, 0]
    return bool(np.abs(top - bottom).max() <= 1e-3 * np.abs(top).max())


def shows_back(lut):
    """True if dust on back faces is shown."""
    return len(lut.header["sides"]) < 2 or turns_over(lut)


def draw(lut, inputs, backfacing, most):
    """(thickness, side) as values: the thickness in [0, `most`], the side 0 for the table's top and 1 for
    the bottom. `inputs`: the group's. `backfacing`: 1 on back faces."""
    front = _clamped(inputs[FRONT], most)
    sheet = len(lut.header["sides"]) > 1
    if not shows_back(lut):
        return front, backfacing
    back = _clamped(inputs[BACK], most)
    if sheet:
        over = (back > front).named("dust on the back")
        return maximum(front, back).named("of the dusty side"), abs(backfacing - over).named("side or other")
    is_own = (inputs[BACK] > 0.5 * AS_FRONT).named("has its own")
    return ((back - front) * (is_own * backfacing) + front).named("of this side"), backfacing


def _clamped(thickness, most):
    return minimum(maximum(thickness, 0.0), most).named(MOST_LABEL)
