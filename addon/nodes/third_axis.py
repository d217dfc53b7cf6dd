# SPDX-License-Identifier: GPL-3.0-or-later
"""The third axis of a table, roughness or azimuth: places in the two rows around a value, and values between
both.

The image interpolates between view angles and thicknesses. With a third axis, each strip is read twice,
unless no layer varies."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Around:
    """`corners`: the places (u, v) in the rows below and above, as sockets, or one for both; `places`:
    v alone of them; `share`: that of the one above, or None."""

    corners: tuple
    places: tuple
    share: object


def around(graph, inputs, corner, v, count, step, is_alone):
    """The places around the group's input Roughness, from the place `corner` with the second number `v`,
    at the first of `count` roughnesses, which are uniform from 0 to 1 and `step` apart in v. With `is_alone`,
    no layer varies, and the image itself interpolates between roughnesses: there is only one place."""
    if count < 2:
        return Around((corner,), (v,), None)
    share = graph.math("ADD", "from 0 to 1", inputs.outputs["Roughness"], 0.0, clamp=True)
    place = graph.math("MULTIPLY", "roughness row", share, float(count - 1))
    if is_alone:
        up = graph.math("MULTIPLY", "v", place, step)
        only = graph.node("ShaderNodeCombineXYZ", "v of the roughness")
        graph.link(up, only.inputs[1])
        corner = graph.vector("ADD", "row", corner, only.outputs[0])
        return Around((corner,), (graph.math("ADD", "v of the row", v, up),), None)
    return between(graph, place, corner, v, count, step)


def between(graph, place, corner, v, count, step):
    """The places around the row `place`, from 0 to count - 1, of the third axis of a table."""
    whole = graph.math("FLOOR", "whole", place)
    below = graph.math("MINIMUM", "row below", whole, float(count - 2))
    share = graph.math("SUBTRACT", "share of the row above", place, below)
    lower = graph.node("ShaderNodeCombineXYZ", "v of the row below")
    up = graph.math("MULTIPLY", "v", below, step)
    graph.link(up, lower.inputs[1])
    first = graph.vector("ADD", "row below", corner, lower.outputs[0])
    second = graph.vector("ADD", "row above", first, (0.0, step, 0.0))
    low = graph.math("ADD", "v below", v, up)
    return Around((first, second), (low, graph.math("ADD", "v above", low, step)), share)
