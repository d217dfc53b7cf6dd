# SPDX-License-Identifier: GPL-3.0-or-later
"""The sockets of closures that move with the view: their shapes stand in strips of the table."""

import math
from typing import NamedTuple

from ..kinds.table import SHAPE, TILT, Strip
from .expression import arctangent, sqrt


class Shape(NamedTuple):
    """The shape of a Glossy BSDF, values or numbers; the normal has any length."""

    roughness: object
    anisotropy: object
    normal: object


class Shapes:
    """`read(strip, label)` reads a strip; `directions`: the Directions of the recipes."""

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
        normal = (of("N") + of("I") * tilt).named("N + k I")
        graph.link(normal, node.inputs["Normal"])
        self.by_closure[closure] = Shape(roughness, anisotropy, normal)

    def _link_oriented(self, node, closure):
        """Roughness, Anisotropy, Rotation from the tangent, and the normal N + k I + l N x I."""
        graph, of = self._graph, self._directions.of
        shape = self._read(Strip(closure, SHAPE), f"shape {closure}")
        roughness, along, across = graph.separate("roughness, a cos 2t, a sin 2t", shape)
        graph.link(roughness, node.inputs["Roughness"])
        graph.link(sqrt(across**2 + along**2).named("a"), node.inputs["Anisotropy"])
        turns = arctangent(across, along) * (0.25 / math.pi)
        graph.link(turns.named("t in turns"), node.inputs["Rotation"])
        graph.link(of("tangent"), node.inputs["Tangent"])
        tilt = self._read(Strip(closure, TILT), f"tilt {closure}")
        towards, aside, _ = graph.separate("k, l", tilt)
        leant = of("N") + of("I") * towards + of("N x I") * aside
        graph.link(leant.named("N + k I + l N x I"), node.inputs["Normal"])
