# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust on two sides of a face: the thickness, and the side of the table, that each side of the face reads.

An opaque stack has its own thickness on either side. The table of a sheet has dust on the sheet's top only;
its bottom side is the view from below, with the dust behind the sheet. Where dust lies on back faces, the
sheet is turned over: back faces then read the table's top. This is right only if both sides of the clean
sheet are alike. Otherwise the table holds no such sheet, and dust on back faces is not shown.
"""

import numpy as np

from .graph import Graph

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


def draw(graph: Graph, lut, inputs, backfacing, most):
    """(thickness, side) as sockets: the thickness in [0, `most`], the side 0 for the table's top and 1 for
    the bottom. `inputs`: the group's input node. `backfacing`: 1 on back faces.
    """
    front = _clamped(graph, "thickness", inputs.outputs[FRONT], most)
    sheet = len(lut.header["sides"]) > 1
    if not shows_back(lut):
        return front, backfacing
    back = _clamped(graph, "thickness of the back", inputs.outputs[BACK], most)
    if sheet:
        over = graph.math("GREATER_THAN", "dust on the back", back, front)
        turned = graph.math("SUBTRACT", "side", backfacing, over)
        return (graph.math("MAXIMUM", "of the dusty side", front, back),
                graph.math("ABSOLUTE", "side or other", turned))
    given = graph.math("GREATER_THAN", "has its own", inputs.outputs[BACK], 0.5 * AS_FRONT)
    chosen = graph.math("MULTIPLY", "and is seen", given, backfacing)
    more = graph.math("SUBTRACT", "back less front", back, front)
    return graph.math("MULTIPLY_ADD", "of this side", more, chosen, front), backfacing


def _clamped(graph, label, socket, most):
    least = graph.math("MAXIMUM", label, socket, 0.0)
    return graph.math("MINIMUM", MOST_LABEL, least, most)
