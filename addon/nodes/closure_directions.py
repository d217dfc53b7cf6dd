# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes for the directions, angles and cosines in the recipes of closures, see lamina.lobes.NodeRecipe."""

import functools
import math

from ..base.messages import RefusedError
from .expression import clamped, cross, normalized

# Where N = I, the plane of incidence is undefined and directions in it would be zero vectors. The cross
# product of I with this vector is added to the directions: its length is far above the rounding of single
# precision, and too small to change any lobe visibly. No likely normal is parallel to the vector.
ASIDE = (0.61e-5, 1.07e-5, 1.57e-5)


class UnknownClosureError(RefusedError):
    """A recipe that this Blender cannot build; str() is one sentence."""


class Directions:
    """The directions of the recipes, each built once: see lamina.lobes.NodeRecipe."""

    def __init__(self, incoming, normal, cosine, angle, tangent=None):
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
            self.multiples[multiple] = (self.angle * multiple).named(f"{multiple:g} view angle")
        return self.multiples[multiple]

    def of_cosine(self, offset, factor, power):
        """offset + factor * (N.I) ** power, clamped to [0, 1]."""
        key = offset, factor, power
        if key not in self.numbers:
            raised = self.powers.get(power)
            if raised is None:
                raised = self.powers[power] = self.cosine**power
            self.numbers[key] = clamped(raised * factor + offset).named("of N.I")
        return self.numbers[key]

    def _make(self, wanted):
        n, i = self.known["N"], self.known["I"]
        if wanted == "N x I":  # its length is a part of the tilt, see lamina's closures.oriented_lobes
            return cross(n, i).named(wanted)
        if wanted == "N+I":
            total = n + i
        elif isinstance(wanted, tuple) and wanted[0] == "lean":
            # R + share N = (share + 2 N.I) N - I
            total = n * (self.cosine * 2.0 + wanted[1]) - i
        elif wanted == "T":
            # N across I; where N = I, any direction perpendicular to I.
            total = n - i * self.cosine + self._aside
        elif wanted == "I aside":
            total = i + self._aside
        elif isinstance(wanted, tuple) and wanted[0] == "tilt":
            angle = math.radians(wanted[1])
            total = self._tangent * math.sin(angle) + n * math.cos(angle)
        else:
            raise UnknownClosureError(f"normal = {wanted!r}: this add-on does not know that direction")
        return normalized(total).named(" ".join(map(str, wanted)) if isinstance(wanted, tuple) else wanted)

    @functools.cached_property
    def _tangent(self):
        """Unit vector across N towards the viewer: normalised I - (N.I) N; any across N where I = N."""
        n, i = self.known["N"], self.known["I"]
        return normalized(i - n * self.cosine + self._aside).named("to the viewer")

    @functools.cached_property
    def _aside(self):
        """A vector of length 2e-5 at most, perpendicular to I, and so to N where N = I."""
        return cross(self.known["I"], ASIDE).named("aside")
