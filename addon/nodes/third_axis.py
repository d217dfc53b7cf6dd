# SPDX-License-Identifier: GPL-3.0-or-later
"""The third axis of a table, roughness or azimuth: places in the two rows around a value, and values between
both.

The image interpolates between view angles and thicknesses. With a third axis, each strip is read twice,
unless no layer varies."""

from dataclasses import dataclass

from .expression import clamped, floor, minimum


@dataclass(frozen=True)
class Around:
    """`corners`: the places (u, v) in the rows below and above, or one for both; `places`:
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
    place = (clamped(inputs["Roughness"]) * float(count - 1)).named("roughness row")
    if is_alone:
        up = place * step
        return Around((corner + graph.combined("v of the roughness", 0.0, up),), (v + up,), None)
    return between(graph, place, corner, v, count, step)


def between(graph, place, corner, v, count, step):
    """The places around the row `place`, from 0 to count - 1, of the third axis of a table."""
    below = minimum(floor(place), float(count - 2)).named("row below")
    up = below * step
    first, low = corner + graph.combined("v of the row below", 0.0, up), v + up
    return Around((first, first + (0.0, step, 0.0)), (low, low + step), place - below)
