# SPDX-License-Identifier: GPL-3.0-or-later
"""The tangent of an anisotropic material, and the azimuth of the view from it, which picks the row of the
table, or with a varying layer the block of rows.

The group's input Tangent may hold any vector, such as that of Cycles' Tangent node. An empty input means the
direction in which u of the active UV map grows. Facets look the same after half a turn, so the sign of the
tangent does not matter, and azimuths are those in half a turn.
"""

import math

from .graph import NEVER_ZERO
from .group_sockets import TANGENT

LEAST = 1e-9  # radians that no one sees


def rows(lut):
    """The number of azimuths of the table, 1 for an isotropic stack."""
    return lut.header["axes"].get("azimuth", {}).get("count", 1)


def draw(graph, lut, inputs, normal, incoming):
    """(the unit tangent of the table's first row, the azimuth of the view from it in [0, pi)): sockets."""
    given = inputs.outputs[TANGENT]
    own = graph.node("ShaderNodeTangent", -1.6, 24, "along u of the UV map")
    own.direction_type = "UV_MAP"
    length = graph.vector("LENGTH", -1.6, 23, "length", given)
    is_given = graph.math("GREATER_THAN", -0.6, 23, "is given", length, 1e-3)
    chosen = graph.mix("VECTOR", 0.4, 23, "tangent", is_given, own.outputs[0], given)
    chosen = graph.vector("ADD", 1.4, 23, "never zero", chosen, NEVER_ZERO)
    across = graph.vector("CROSS_PRODUCT", 2.4, 23, "across", normal, chosen)
    across = graph.vector("NORMALIZE", 3.4, 23, "B", across)
    along = graph.vector("CROSS_PRODUCT", 4.4, 23, "T", across, normal)
    turn = lut.header["axes"]["azimuth"]["tangent"]
    if turn > LEAST:
        cosine, sine = math.cos(turn), math.sin(turn)
        along, across = (
            graph.vector("ADD", 5.4, 22 + line, name, graph.scale(4.4, 22 + line, "cos", one, cosine),
                         graph.scale(4.4, 24 + line, "sin", other, factor))
            for line, name, one, other, factor in ((0, "T turned", along, across, sine),
                                                   (1, "B turned", across, along, -sine)))
    x = graph.vector("DOT_PRODUCT", 6.4, 22, "I along T", incoming, along)
    y = graph.vector("DOT_PRODUCT", 6.4, 23, "I along B", incoming, across)
    azimuth = graph.math("ARCTAN2", 7.4, 22, "azimuth", y, x)
    return along, graph.math("FLOORED_MODULO", 8.4, 22, "in half a turn", azimuth, math.pi)
