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
    """`read(strip, label)` reads a strip and returns a socket; `directions`: the Directions of
    the recipes."""

    def __init__(self, graph, read, directions):
        self._graph, self._read, self._directions = graph, read, directions
        self.by_closure = {}  # the Shape of each closure that moves and does not turn

    def link(self, node, closure, turns):
        """Roughness, Anisotropy, and the normal N + k I; or, if the closure `turns`, see lamina's
        closures.oriented_lobes."""
        graph, of = self._graph, self._directions.of
        if turns:
            self._link_oriented(node, closure)
            return
        shape = self._read(Strip(closure, SHAPE), f"shape {closure}")
        roughness, anisotropy, tilt = graph.separate("roughness, anisotropy, k", shape)
        graph.link(roughness, node.inputs["Roughness"])
        graph.link(anisotropy, node.inputs["Anisotropy"])
        towards = graph.scale("k I", of("I"), tilt)
        normal = graph.vector("ADD", "N + k I", of("N"), towards)
        graph.link(normal, node.inputs["Normal"])
        self.by_closure[closure] = Shape(roughness, anisotropy, normal)

    def _link_oriented(self, node, closure):
        """Roughness, Anisotropy, Rotation from the tangent, and the normal N + k I + l N x I."""
        graph, of = self._graph, self._directions.of
        shape = self._read(Strip(closure, SHAPE), f"shape {closure}")
        roughness, along, across = graph.separate("roughness, a cos 2t, a sin 2t", shape)
        graph.link(roughness, node.inputs["Roughness"])
        square = graph.math("MULTIPLY", "a^2", across, across)
        square = graph.math("MULTIPLY_ADD", "a^2", along, along, square)
        graph.link(graph.math("SQRT", "a", square), node.inputs["Anisotropy"])
        twice = graph.math("ARCTAN2", "2 t", across, along)
        share = graph.math("MULTIPLY", "t in turns", twice, 0.25 / math.pi)
        graph.link(share, node.inputs["Rotation"])
        graph.link(of("tangent"), node.inputs["Tangent"])
        tilt = self._read(Strip(closure, TILT), f"tilt {closure}")
        towards, aside, _ = graph.separate("k, l", tilt)
        leant = graph.vector("ADD", "N + k I", of("N"), graph.scale("k I", of("I"), towards))
        leant = graph.vector("ADD", "+ l N x I", leant, graph.scale("l N x I", of("N x I"), aside))
        graph.link(leant, node.inputs["Normal"])
