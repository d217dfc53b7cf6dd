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
    own = graph.node("ShaderNodeTangent", "along u of the UV map")
    own.direction_type = "UV_MAP"
    length = graph.vector("LENGTH", "length", given)
    is_given = graph.math("GREATER_THAN", "is given", length, 1e-3)
    chosen = graph.mix("VECTOR", "tangent", is_given, own.outputs[0], given)
    chosen = graph.vector("ADD", "never zero", chosen, NEVER_ZERO)
    across = graph.vector("CROSS_PRODUCT", "across", normal, chosen)
    across = graph.vector("NORMALIZE", "B", across)
    along = graph.vector("CROSS_PRODUCT", "T", across, normal)
    turn = lut.header["axes"]["azimuth"]["tangent"]
    if turn > LEAST:
        cosine, sine = math.cos(turn), math.sin(turn)
        along, across = (
            graph.vector("ADD", name, graph.scale("cos", one, cosine), graph.scale("sin", other, factor))
            for name, one, other, factor in (
                ("T turned", along, across, sine), ("B turned", across, along, -sine)))
    x = graph.vector("DOT_PRODUCT", "I along T", incoming, along)
    y = graph.vector("DOT_PRODUCT", "I along B", incoming, across)
    azimuth = graph.math("ARCTAN2", "azimuth", y, x)
    return along, graph.math("FLOORED_MODULO", "in half a turn", azimuth, math.pi)
