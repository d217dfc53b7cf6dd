# SPDX-License-Identifier: GPL-3.0-or-later
"""The tangent of an anisotropic material, and the azimuth of the view from it, which picks the row of the
table, or with a varying layer the block of rows.

The group's input Tangent may hold any vector, such as that of Cycles' Tangent node. An empty input means the
direction in which u of the active UV map grows. Facets look the same after half a turn, so the sign of the
tangent does not matter, and azimuths are those in half a turn.
"""

import math

from .expression import arctangent, cross, dot, floored_modulo, length, normalized
from .graph import NEVER_ZERO
from .group_sockets import TANGENT

LEAST = 1e-9  # radians that no one sees


def rows(lut):
    """The number of azimuths of the table, 1 for an isotropic stack."""
    return lut.header["axes"].get("azimuth", {}).get("count", 1)


def draw(graph, lut, inputs, normal, incoming):
    """(the unit tangent of the table's first row, the azimuth of the view from it in [0, pi))."""
    given = inputs[TANGENT]
    own = graph.node("ShaderNodeTangent", "along u of the UV map")
    own.direction_type = "UV_MAP"
    is_given = (length(given) > 1e-3).named("is given")
    chosen = graph.mix("VECTOR", "tangent", is_given, own.outputs[0], given) + NEVER_ZERO
    across = normalized(cross(normal, chosen)).named("B")
    along = cross(across, normal).named("T")
    turn = lut.header["axes"]["azimuth"]["tangent"]
    if turn > LEAST:
        cosine, sine = math.cos(turn), math.sin(turn)
        along, across = along * cosine + across * sine, across * cosine - along * sine
    azimuth = arctangent(dot(incoming, across), dot(incoming, along))
    return along, floored_modulo(azimuth, math.pi).named("in half a turn")
