# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a point of a surface looks into its table: the normal, the view angle u, and the row v of its
thickness, side and azimuth.

u = (theta_o / (pi/2) * 63 + .5) / 64 and v = (strip * rows + t * (rows - 1) + .5) / height address the
texel centres of the LUT (see lamina.Lut). Each texture's own mapping computes u and adds the strip: Cycles
runs one instruction for a mapping, and two for a node with a constant. The strips of a sheet's bottom side
follow those of its top side, and back faces read them. Cycles has already turned the normal towards the
viewer there."""

import math
from typing import NamedTuple

from ..kinds.table import TAU_BEND
from . import side_graph
from .expression import arccosine, arctangent, cross, dot, floored_modulo, length, normalized
from .graph import NEVER_ZERO
from .group_sockets import TANGENT

SCALE_LABEL = "rows"
ANGLE_COLOUR = (0.16, 0.24, 0.34)
NORMAL_COLOUR = (0.20, 0.20, 0.36)
ROW_COLOUR = (0.18, 0.30, 0.24)
_LEAST = 1e-9  # radians that no one sees


class View(NamedTuple):
    """The group's inputs by name, and values: the direction to the viewer, the normal, their cosine and
    angle, the tangent or None, v, and the place (view angle, v). turn: the row of the azimuth, where a layer
    varies too; otherwise None."""

    inputs: dict
    incoming: object
    normal: object
    cosine: object
    angle: object
    tangent: object
    v: object
    place: object
    turn: object


def roughness_rows(lut):
    """The number of roughnesses of the table, 1 without such an axis."""
    return lut.header["axes"].get("roughness", {}).get("count", 1)


def azimuths(lut):
    """The number of azimuths of the table, 1 for an isotropic stack."""
    return lut.header["axes"].get("azimuth", {}).get("count", 1)


def largest_tau(lut):
    """The varying layer's optical thickness at the last row, or None if no layer varies."""
    axis = lut.header["axes"]["tau"]
    return float(axis["values"][-1]) if axis["count"] > 1 else None


def draw(graph, lut, height):
    """The View of a table in an image of `height` texels."""
    rows = lut.header["axes"]["tau"]["count"]
    inputs = graph.values(graph.node("NodeGroupInput", folded=False))
    geometry = graph.values(graph.node("ShaderNodeNewGeometry", folded=False))
    incoming = geometry["Incoming"]

    graph.begin_frame("Normal (the surface's own when the input is empty)", NORMAL_COLOUR)
    normal = normal_of(graph, inputs["Normal"], geometry["Normal"])
    graph.begin_frame("View angle", ANGLE_COLOUR)
    cosine = dot(incoming, normal).named("view cosine")
    angle = arccosine(cosine).named("view angle")
    graph.begin_frame("Thickness and side to row v", ROW_COLOUR)
    v, tangent, turn = _row(lut, inputs, geometry["Backfacing"], rows, height), None, None
    if azimuths(lut) > 1:
        graph.begin_frame("Azimuth of the view from the tangent to row v", ROW_COLOUR)
        tangent, azimuth = _tangent_and_azimuth(graph, lut, inputs, normal, incoming)
        per_radian = (azimuths(lut) - 1) / math.pi
        if rows == 1:
            v = (azimuth * (per_radian / height) + v).named("v of the azimuth")
        else:
            turn = (azimuth * per_radian).named("row of the azimuth")
    graph.end_frame()
    place = graph.combined("view angle, v", angle, v)
    return View(inputs, incoming, normal, cosine, angle, tangent, v, place, turn)


def normal_of(graph, given, own):
    """The group's Normal input, or the surface's normal while nothing is linked to it (a zero vector)."""
    is_given = (length(given) > 0.5).named("is given")
    return normalized(graph.mix("VECTOR", "normal", is_given, own, given)).named("N")


def _tangent_and_azimuth(graph, lut, inputs, normal, incoming):
    """(the unit tangent of the table's first row, the azimuth of the view from it in [0, pi)).

    The group's input Tangent may hold any vector, such as that of Cycles' Tangent node. An empty input means
    the direction in which u of the active UV map grows. Facets look the same after half a turn, so the sign
    of the tangent does not matter, and azimuths are those in half a turn."""
    given = inputs[TANGENT]
    own = graph.node("ShaderNodeTangent", "along u of the UV map")
    own.direction_type = "UV_MAP"
    is_given = (length(given) > 1e-3).named("is given")
    chosen = graph.mix("VECTOR", "tangent", is_given, own.outputs[0], given) + NEVER_ZERO
    across = normalized(cross(normal, chosen)).named("B")
    along = cross(across, normal).named("T")
    turn = lut.header["axes"]["azimuth"]["tangent"]
    if turn > _LEAST:
        cosine, sine = math.cos(turn), math.sin(turn)
        along, across = along * cosine + across * sine, across * cosine - along * sine
    azimuth = arctangent(dot(incoming, across), dot(incoming, along))
    return along, floored_modulo(azimuth, math.pi).named("in half a turn")


def _row(lut, inputs, backfacing, rows, height):
    """v of strip 0 without the half texel, which each strip adds: a value, or the number 0."""
    tau, side = None, backfacing
    if rows > 1:
        most, scale = _thickness_scale(lut, rows, height)
        tau, side = side_graph.draw(lut, inputs, backfacing, most)
    first = 0.0
    if len(lut.header["sides"]) > 1:
        strips = len(lut.header["closures"])
        first = (side * (strips * rows / height)).named("bottom side's strips")
    if rows == 1:
        return first
    return (tau / (tau + TAU_BEND) * scale).named(SCALE_LABEL) + first


def _thickness_scale(lut, rows, height):
    """(largest thickness in the table, factor from tau / (tau + 1/2) to v)."""
    largest = largest_tau(lut)
    last = 1.0 if math.isinf(largest) else largest / (largest + TAU_BEND)
    return min(largest, 1.0e30), (rows - 1) / height / last if last else 0.0


def rescale(tree, table):
    """Changes a drawn tree to the thickness axis of another table of the same layout."""
    rows = table.lut.header["axes"]["tau"]["count"]
    if rows > 1:
        most, scale = _thickness_scale(table.lut, rows, table.height)
        values = {side_graph.MOST_LABEL: most, SCALE_LABEL: scale}
        for node in tree.nodes:
            if node.type == "MATH" and node.label in values:
                node.inputs[1].default_value = values[node.label]
