# SPDX-License-Identifier: GPL-3.0-or-later
"""Strips of the table as Eevee has to read them: texels without filtering, interpolated by nodes.

Eevee filters images by mipmaps. Where the view angle changes much from pixel to pixel, as at silhouettes, it
reads a smaller picture, in which several strips are mixed. Only the interpolation Closest has no mipmaps.
"""

import math

from .expression import floor, minimum


class Texels:
    """Reads strips of an image.

    `angle`: the view angle, 0 to pi/2 over `columns` columns. `around`: the places of strip 0, without the
    half texel, in an image of `height` texels, see third_axis. `rows`: of a strip; `first`: of the
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
