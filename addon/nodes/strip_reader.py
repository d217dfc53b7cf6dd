# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads strips of a table from its image, for Cycles and for Eevee.

The image interpolates between view angles and thicknesses. With a third axis, roughness or azimuth, each
strip is read twice, in the rows around the value, unless no layer varies."""

import math
from dataclasses import dataclass

from ..kinds.table import strips_of
from . import eevee_graph, table_view
from .expression import clamped, floor, minimum


class Reader:
    """Strips of a Table of lut_image in `image`, at the place of a table_view.View. `chooser`: see
    eevee_graph; `texels`: Texels."""

    def __init__(self, graph, table, image, view):
        self._graph, self._table, self._image = graph, table, image
        lut, axes = table.lut, table.lut.header["axes"]
        rows, self._columns = axes["tau"]["count"], axes["view"]["count"]
        self._strips, self._textures = strips_of(lut.header), {}
        self._rows = rows * table_view.roughness_rows(lut) * table_view.azimuths(lut)
        step = rows / table.height
        where = view.place, view.v
        if view.turn is None:
            count = table_view.roughness_rows(lut)
            self._around = _around(graph, view.inputs, *where, count, step, rows == 1)
        else:
            count = table_view.azimuths(lut)
            self._around = _between(graph, view.turn, *where, count, step)
        graph.begin_frame("Texels for Eevee", table_view.ANGLE_COLOUR)
        self.chooser = eevee_graph.is_eevee(graph)
        self.texels = Texels(
            graph, image, view.angle, self._columns, table.height, self._rows, self._around, table.first)

    def read(self, strip, label):
        """The color of a strip, as Cycles finds it."""
        index, around = self._strips.index(strip), self._around
        if around.share is None:
            return self._look_up(around.corners[0], index, label)
        lower, upper = (self._look_up(one, index, label) for one in around.corners)
        return self._graph.mix("VECTOR", "between", around.share, lower, upper)

    def alpha(self, strip, label):
        """The number in the alpha of a strip, as Cycles finds it."""
        index = self._strips.index(strip)
        if index not in self._textures:
            self.read(strip, label)
        held = [self._graph.value(texture.outputs["Alpha"]) for texture in self._textures[index]]
        if len(held) == 1:
            return held[0]
        return self._graph.mix("FLOAT", "between", self._around.share, *held)

    def of_both(self, strip, label, number=None):
        """A strip that Cycles and Eevee share. `number`: where Cycles finds it, if not in the strip."""
        value = self.read(strip, label) if number is None else number
        index, name = self._strips.index(strip), f"{eevee_graph.LABEL} {label}"
        (exact,) = self.texels.read(index, name, alpha=False)
        kind = "RGBA" if number is None else "FLOAT"
        return eevee_graph.chosen_value(self._graph, self.chooser, value, exact, kind)

    def _look_up(self, place, index, label):
        texture = self._graph.node("ShaderNodeTexImage", label)
        texture.image = self._image
        texture.interpolation, texture.extension = "Linear", "EXTEND"
        columns, row = self._columns, self._table.first + index * self._rows
        texture.texture_mapping.scale = ((columns - 1) / columns / (math.pi / 2), 1.0, 1.0)
        texture.texture_mapping.translation = (0.5 / columns, (row + 0.5) / self._table.height, 0.0)
        self._graph.link(place, texture.inputs[0])
        self._textures.setdefault(index, []).append(texture)
        return self._graph.value(texture.outputs["Color"])


@dataclass(frozen=True)
class _Around:
    """`corners`: the places (u, v) in the rows below and above, or one for both; `places`:
    v alone of them; `share`: that of the one above, or None."""

    corners: tuple
    places: tuple
    share: object


def _around(graph, inputs, corner, v, count, step, is_alone):
    """The places around the group's input Roughness, from the place `corner` with the second number `v`,
    at the first of `count` roughnesses, which are uniform from 0 to 1 and `step` apart in v. With `is_alone`,
    no layer varies, and the image itself interpolates between roughnesses: there is only one place."""
    if count < 2:
        return _Around((corner,), (v,), None)
    place = (clamped(inputs["Roughness"]) * float(count - 1)).named("roughness row")
    if is_alone:
        up = place * step
        return _Around((corner + graph.combined("v of the roughness", 0.0, up),), (v + up,), None)
    return _between(graph, place, corner, v, count, step)


def _between(graph, place, corner, v, count, step):
    """The places around the row `place`, from 0 to count - 1, of the third axis of a table."""
    below = minimum(floor(place), float(count - 2)).named("row below")
    up = below * step
    first, low = corner + graph.combined("v of the row below", 0.0, up), v + up
    return _Around((first, first + (0.0, step, 0.0)), (low, low + step), place - below)


class Texels:
    """Strips as Eevee has to read them: texels without filtering, interpolated by nodes. Eevee filters images
    by mipmaps: where the view angle changes much from pixel to pixel, as at silhouettes, it reads a smaller
    picture, in which several strips are mixed. Only the interpolation Closest has no mipmaps.

    `angle`: the view angle, 0 to pi/2 over `columns` columns. `around`: the places of strip 0, without the
    half texel, in an image of `height` texels. `rows`: of a strip; `first`: of the
    table."""

    def __init__(self, graph, image, angle, columns, height, rows, around, first=0):
        self.graph, self.image, self.height, self.rows, self.share = graph, image, height, rows, around.share
        self.first = first
        last = columns - 1
        place = minimum(angle * (last / (math.pi / 2)), float(last))
        left = minimum(floor(place), float(last - 1)).named("column to the left")
        self.across = (place - left).named("share of the right")
        u = left * (1.0 / columns) + 0.5 / columns
        self.step = 1.0 / columns
        self.corners = [self._corner(u, v) for v in around.places]

    def read(self, index, label, alpha=True):
        """[color, alpha] of strip `index`, or [color]."""
        names = ("Color", "Alpha") if alpha else ("Color",)
        at = [self._at_thickness(*corner, index, label, names) for corner in self.corners]
        return at[0] if self.share is None else self._mixed(self.share, *at)

    def _corner(self, u, v):
        """(place of the texel below and to the left, share of the row above)."""
        up = None
        if self.rows > 1:  # v may lie between two of them
            row = v * float(self.height)
            whole = floor(row)
            up = (row - whole).named("share of the row above")
            v = whole * (1.0 / self.height)
        return self.graph.combined("u, v", u, v), up

    def _at_thickness(self, corner, up, index, label, names):
        first = self.first + index * self.rows
        below = self._row(corner, first, label, names)
        if up is None:
            return below
        return self._mixed(up, below, self._row(corner, first + 1, label, names))

    def _row(self, corner, first, label, names):
        pair = [self._texel(corner, x * self.step, (first + 0.5) / self.height, label, names)
                for x in (0, 1)]
        return self._mixed(self.across, *pair)

    def _texel(self, corner, x, y, label, names):
        texture = self.graph.node("ShaderNodeTexImage", label)
        texture.image, texture.interpolation, texture.extension = self.image, "Closest", "EXTEND"
        self.graph.link(corner + (x, y, 0.0), texture.inputs[0])
        return [self.graph.value(texture.outputs[name]) for name in names]

    def _mixed(self, share, first, second):
        return [self.graph.mix("RGBA" if one.is_vector else "FLOAT", "between", share, one, other)
                for one, other in zip(first, second, strict=True)]
