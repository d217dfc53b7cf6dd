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

    def of(self, wanted):
        wanted = tuple(wanted) if isinstance(wanted, list) else wanted
        if wanted not in self.known:
            self.known[wanted] = self._make(wanted)
        return self.known[wanted]

    def view_angle(self, multiple):
        """`multiple` times the angle between I and N, in radians."""
        if multiple not in self.multiples:
            name = f"{multiple:g} view angle"
            self.multiples[multiple] = self.graph.math("MULTIPLY", name, self.angle, multiple)
        return self.multiples[multiple]

    def of_cosine(self, offset, factor, power):
        """offset + factor * (N.I) ** power, clamped to [0, 1]."""
        graph, key = self.graph, (offset, factor, power)
        if key not in self.numbers:
            raised = self.powers.get(power)
            if raised is None:
                raised = graph.math("POWER", f"(N.I)^{power:g}", self.cosine, power)
                self.powers[power] = raised
            self.numbers[key] = graph.math("MULTIPLY_ADD", "of N.I", raised, factor, offset, clamp=True)
        return self.numbers[key]

    def _make(self, wanted):
        graph, normal, incoming = self.graph, self.known["N"], self.known["I"]
        if wanted == "N x I":  # its length is a part of the tilt, see lamina's closures.oriented_lobes
            return graph.vector("CROSS_PRODUCT", "N x I", normal, incoming)
        if wanted == "N+I":
            total = graph.vector("ADD", "N + I", normal, incoming)
        elif isinstance(wanted, tuple) and wanted[0] == "lean":
            # R + share N = (share + 2 N.I) N - I
            twice = graph.math("MULTIPLY_ADD", "share + 2 N.I", self.cosine, 2.0, wanted[1])
            along = graph.scale("along N", normal, twice)
            total = graph.vector("SUBTRACT", f"R + {wanted[1]:g} N", along, incoming)
        elif wanted == "T":
            # N across I; where N = I, any direction perpendicular to I.
            along = graph.scale("(N.I) I", incoming, self.cosine)
            across = graph.vector("SUBTRACT", "N across I", normal, along)
            total = graph.vector("ADD", "square to I", across, self._aside)
        elif wanted == "I aside":
            total = graph.vector("ADD", "I aside", incoming, self._aside)
        elif isinstance(wanted, tuple) and wanted[0] == "tilt":
            angle = math.radians(wanted[1])
            across = graph.scale("sin", self._tangent, math.sin(angle))
            along = graph.scale("cos", normal, math.cos(angle))
            total = graph.vector("ADD", f"N tilted {wanted[1]:g}", along, across)
        else:
            raise UnknownClosureError(f"normal = {wanted!r}: this add-on does not know that direction")
        return graph.vector("NORMALIZE", "unit", total)

    @functools.cached_property
    def _tangent(self):
        """Unit vector across N towards the viewer: normalised I - (N.I) N; any across N where I = N."""
        graph = self.graph
        along = graph.scale("(N.I) N", self.known["N"], self.cosine)
        across = graph.vector("SUBTRACT", "I across N", self.known["I"], along)
        across = graph.vector("ADD", "never zero", across, self._aside)
        return graph.vector("NORMALIZE", "to the viewer", across)

    @functools.cached_property
    def _aside(self):
        """A vector of length 2e-5 at most, perpendicular to I, and so to N where N = I."""
        return self.graph.vector("CROSS_PRODUCT", "aside", self.known["I"], ASIDE)
