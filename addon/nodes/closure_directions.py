# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes for the directions, angles and cosines in the recipes of closures, see lamina.lobes.NodeRecipe."""

import functools
import math

from ..base.messages import RefusedError

# Where N = I, the plane of incidence is undefined and directions in it would be zero vectors. The cross
# product of I with this vector is added to the directions: its length is far above the rounding of single
# precision, and too small to change any lobe visibly. No likely normal is parallel to the vector.
ASIDE = (0.61e-5, 1.07e-5, 1.57e-5)


class UnknownClosureError(RefusedError):
    """A recipe that this Blender cannot build; str() is one sentence."""


class Directions:
    """The directions of the recipes, each built once: see lamina.lobes.NodeRecipe."""

    def __init__(self, graph, incoming, normal, cosine, angle, tangent=None):
        self.graph = graph
        self.cosine = cosine
        self.angle = angle
        self.multiples, self.powers, self.numbers = {}, {}, {}
        self.known = {"N": normal, "I": incoming, "tangent": tangent}
        self.line = 10.2

    def of(self, wanted):
        wanted = tuple(wanted) if isinstance(wanted, list) else wanted
        if wanted not in self.known:
            self.known[wanted] = self._make(wanted)
        return self.known[wanted]

    def view_angle(self, multiple):
        """`multiple` times the angle between I and N, in radians."""
        if multiple not in self.multiples:
            self.line += 1
            name = f"{multiple:g} view angle"
            scaled = self.graph.math("MULTIPLY", 3.4, self.line, name, self.angle, multiple)
            self.multiples[multiple] = scaled
        return self.multiples[multiple]

    def of_cosine(self, offset, factor, power):
        """offset + factor * (N.I) ** power, clamped to [0, 1]."""
        graph, key = self.graph, (offset, factor, power)
        if key not in self.numbers:
            self.line += 1
            raised = self.powers.get(power)
            if raised is None:
                raised = graph.math("POWER", 2.4, self.line, f"(N.I)^{power:g}", self.cosine, power)
                self.powers[power] = raised
            self.numbers[key] = graph.math("MULTIPLY_ADD", 3.4, self.line, "of N.I", raised, factor, offset,
                                           clamp=True)
        return self.numbers[key]

    def _make(self, wanted):
        graph, normal, incoming = self.graph, self.known["N"], self.known["I"]
        self.line += 1
        if wanted == "N x I":  # its length is a part of the tilt, see lamina's closures.oriented_lobes
            return graph.vector("CROSS_PRODUCT", 2.4, self.line, "N x I", normal, incoming)
        if wanted == "N+I":
            total = graph.vector("ADD", 2.4, self.line, "N + I", normal, incoming)
        elif isinstance(wanted, tuple) and wanted[0] == "lean":
            # R + share N = (share + 2 N.I) N - I
            twice = graph.math("MULTIPLY_ADD", 0.4, self.line, "share + 2 N.I", self.cosine, 2.0, wanted[1])
            along = graph.scale(1.4, self.line, "along N", normal, twice)
            total = graph.vector("SUBTRACT", 2.4, self.line, f"R + {wanted[1]:g} N", along, incoming)
        elif wanted == "T":
            # N across I; where N = I, any direction perpendicular to I.
            along = graph.scale(-0.6, self.line, "(N.I) I", incoming, self.cosine)
            across = graph.vector("SUBTRACT", 0.4, self.line, "N across I", normal, along)
            total = graph.vector("ADD", 2.4, self.line, "square to I", across, self._aside)
        elif wanted == "I aside":
            total = graph.vector("ADD", 2.4, self.line, "I aside", incoming, self._aside)
        elif isinstance(wanted, tuple) and wanted[0] == "tilt":
            angle = math.radians(wanted[1])
            across = graph.scale(0.4, self.line, "sin", self._tangent, math.sin(angle))
            along = graph.scale(1.4, self.line, "cos", normal, math.cos(angle))
            total = graph.vector("ADD", 2.4, self.line, f"N tilted {wanted[1]:g}", along, across)
        else:
            raise UnknownClosureError(f"normal = {wanted!r}: this add-on does not know that direction")
        return graph.vector("NORMALIZE", 3.4, self.line, "unit", total)

    @functools.cached_property
    def _tangent(self):
        """Unit vector across N towards the viewer: normalised I - (N.I) N; any across N where I = N."""
        graph = self.graph
        along = graph.scale(-2.6, self.line, "(N.I) N", self.known["N"], self.cosine)
        across = graph.vector("SUBTRACT", -1.6, self.line, "I across N", self.known["I"], along)
        across = graph.vector("ADD", -0.6, self.line, "never zero", across, self._aside)
        self.line += 1
        return graph.vector("NORMALIZE", 0.4, self.line - 1, "to the viewer", across)

    @functools.cached_property
    def _aside(self):
        """A vector of length 2e-5 at most, perpendicular to I, and so to N where N = I."""
        return self.graph.vector("CROSS_PRODUCT", 1.4, 9.6, "aside", self.known["I"], ASIDE)
