# SPDX-License-Identifier: GPL-3.0-or-later
"""The sockets of closures that move with the view: their shapes stand in strips of the table."""

import math
from typing import NamedTuple

from ..kinds.table import SHAPE, TILT, Strip


class Shape(NamedTuple):
    """The shape of a Glossy BSDF, sockets or numbers; the normal has any length."""

    roughness: object
    anisotropy: object
    normal: object


class Shapes:
    """`read(strip, column, line, label)` reads a strip and returns a socket; `directions`: the Directions of
    the recipes."""

    def __init__(self, graph, read, directions):
        self._graph, self._read, self._directions = graph, read, directions
        self.by_closure = {}  # the Shape of each closure that moves and does not turn

    def link(self, node, closure, line, turns):
        """Roughness, Anisotropy, and the normal N + k I; or, if the closure `turns`, see lamina's
        closures.oriented_lobes."""
        graph, of = self._graph, self._directions.of
        place = line + 0.5
        if turns:
            self._link_oriented(node, closure, place)
            return
        shape = self._read(Strip(closure, SHAPE), 7, place, f"shape {closure}")
        roughness, anisotropy, tilt = graph.separate(8.6, place, "roughness, anisotropy, k", shape)
        graph.link(roughness, node.inputs["Roughness"])
        graph.link(anisotropy, node.inputs["Anisotropy"])
        towards = graph.scale(9.2, place, "k I", of("I"), tilt)
        normal = graph.vector("ADD", 9.8, place, "N + k I", of("N"), towards)
        graph.link(normal, node.inputs["Normal"])
        self.by_closure[closure] = Shape(roughness, anisotropy, normal)

    def _link_oriented(self, node, closure, place):
        """Roughness, Anisotropy, Rotation from the tangent, and the normal N + k I + l N x I."""
        graph, of = self._graph, self._directions.of
        shape = self._read(Strip(closure, SHAPE), 7, place, f"shape {closure}")
        roughness, along, across = graph.separate(8.6, place, "roughness, a cos 2t, a sin 2t", shape)
        graph.link(roughness, node.inputs["Roughness"])
        square = graph.math("MULTIPLY", 9.2, place, "a^2", across, across)
        square = graph.math("MULTIPLY_ADD", 9.5, place, "a^2", along, along, square)
        graph.link(graph.math("SQRT", 9.8, place, "a", square), node.inputs["Anisotropy"])
        twice = graph.math("ARCTAN2", 9.2, place + 0.3, "2 t", across, along)
        share = graph.math("MULTIPLY", 9.8, place + 0.3, "t in turns", twice, 0.25 / math.pi)
        graph.link(share, node.inputs["Rotation"])
        graph.link(of("tangent"), node.inputs["Tangent"])
        tilt = self._read(Strip(closure, TILT), 7, place + 0.6, f"tilt {closure}")
        towards, aside, _ = graph.separate(8.6, place + 0.6, "k, l", tilt)
        leant = graph.vector("ADD", 9.8, place + 0.6, "N + k I", of("N"),
                             graph.scale(9.2, place + 0.6, "k I", of("I"), towards))
        leant = graph.vector("ADD", 10.1, place + 0.6, "+ l N x I", leant,
                             graph.scale(9.2, place + 0.9, "l N x I", of("N x I"), aside))
        graph.link(leant, node.inputs["Normal"])
