# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads strips of a table from its image, for Cycles and for Eevee."""

import math

from ..kinds.table import strips_of
from . import azimuth_graph, eevee_graph, eevee_lookup, table_view, third_axis


class Reader:
    """Strips of a Table of lut_image in `image`, at the place of a table_view.View. `chooser`, `texels`: see
    eevee_graph and eevee_lookup."""

    def __init__(self, graph, table, image, view):
        self._graph, self._table, self._image = graph, table, image
        lut, axes = table.lut, table.lut.header["axes"]
        rows, self._columns = axes["tau"]["count"], axes["view"]["count"]
        self._strips, self._textures = strips_of(lut.header), {}
        self._rows = rows * table_view.roughness_rows(lut) * azimuth_graph.rows(lut)
        step = rows / table.height
        where = view.place, view.v
        if view.turn is None:
            count = table_view.roughness_rows(lut)
            self._around = third_axis.around(graph, view.inputs, *where, count, step, rows == 1)
        else:
            count = azimuth_graph.rows(lut)
            self._around = third_axis.between(graph, view.turn, *where, count, step)
        graph.begin_frame("Texels for Eevee", table_view.ANGLE_COLOUR)
        self.chooser = eevee_graph.is_eevee(graph)
        self.texels = eevee_lookup.Texels(
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
