# SPDX-License-Identifier: GPL-3.0-or-later
"""A closure of Cycles: its closed form, and the recipe of its node.

Conventions: `mu_o`, `mu_i` in (0, 1] are the cosines of viewer and light with the normal, `dphi` in
radians is 0 when the light keeps its azimuth (forward) and pi back towards the light.  The viewer is
at (sin theta_o, 0, cos theta_o), so the light is at (-sin theta_i cos dphi, -sin theta_i sin dphi,
+-cos theta_i): above the surface for a reflection lobe, below it for a transmission lobe.
"""
from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

Normal = str | tuple[str, float]
Evaluate = Callable[..., np.ndarray]

GEOMETRIC = "N"
INCOMING = "I"
ASIDE = "I aside"


@dataclass(frozen=True)
class NodeRecipe:
    """How to build a closure out of one shader node; plain data, interpreted by the add-on.

    `weight_input` takes the linear RGB weight. `inputs` are socket values by name, `enums` are node properties.
    `normal` (for the socket `normal_input`) is "N", "I", "N+I" (the normalised sum), ("lean", share): R + share N,
    where R mirrors I at N, or ("tilt", degrees): N turned towards the viewer, in the plane of incidence. `vectors` are
    further sockets that take a direction: "I" is the vector Geometry.Incoming, "T" the vector in the plane of incidence
    that is perpendicular to I, "I aside" the vector I turned by some 1e-5 radians. Cycles renders black if a tangent is
    parallel to the normal; "I aside" is a tangent that is valid also where I is the normal, seen exactly from above.
    `view_angles` are sockets whose value is a multiple of the view angle theta_o, in radians. `of_cosine` are sockets
    by (offset, factor, power): their value is offset + factor * mu_o ** power, clamped to [0, 1].
    `width`, (scale, least), belongs to a closure that follows the roughness of the base: its width is
    following_lobes.width. `of_width` are sockets by (factor, power): their value is factor * width ** power, at most 1.
    `moves`: the table holds Roughness, Anisotropy and the tilt k of the normal, which is N + k I: see moving_lobes.
    `turns`: it also holds the rotation from the layer's tangent, and a tilt l along N x I: see oriented_lobes.
    """

    type: str
    weight_input: str = "Color"
    inputs: Mapping[str, object] = field(default_factory=dict)
    enums: Mapping[str, str] = field(default_factory=dict)
    normal: Normal = GEOMETRIC
    normal_input: str = "Normal"
    vectors: Mapping[str, Normal] = field(default_factory=dict)
    view_angles: Mapping[str, float] = field(default_factory=dict)
    of_cosine: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    width: tuple[float, float] | None = None
    of_width: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    moves: bool = False
    turns: bool = False


@dataclass(frozen=True)
class Cone:
    """The extent of a lobe about its recipe's normal: it is 0 beyond `reach` radians, and its integral is `whole`."""

    reach: float
    whole: float


@dataclass(frozen=True)
class Lobe:
    """One closure of unit weight: `evaluate(mu_o, mu_i, dphi)` -> f * |cos theta_i|, broadcast, 1/sr. `narrow`:
    integrals need directions that are dense about the mirror direction. `cone`: the extent of a lobe with an edge.
    `density`: the probability density of directions that Cycles samples for a reflection lobe, 1/sr; None: equal to the
    value. `strayed`: for a transmission lobe, the probability density of directions that Cycles samples above the
    horizon; None: it samples none."""

    id: str
    side: str
    evaluate: Evaluate = field(repr=False, compare=False)
    node: NodeRecipe = field(repr=False, compare=False)
    narrow: bool = False
    cone: Cone | None = None
    density: Evaluate | None = field(default=None, repr=False, compare=False)
    strayed: Evaluate | None = field(default=None, repr=False, compare=False)

    @property
    def leans(self) -> bool:
        """True if the lobe is about a direction other than the normal and the mirror direction, so that it can cross
        the horizon. The integral of such a lobe over all directions is 1."""
        return self.node.normal != GEOMETRIC or self.strays

    @property
    def strays(self) -> bool:
        """True if Cycles samples the lobe beyond the horizon."""
        return self.strayed is not None


class Geometry:
    """The two directions of a configuration in the frame whose z axis is the surface normal. Each array has the shape
    of the arguments it depends on; on a product grid most arrays stay small, and combinations broadcast."""

    def __init__(self, mu_o, mu_i, dphi, below: bool = False):
        self.mu_o, self.mu_i, dphi = (np.asarray(x, float) for x in (mu_o, mu_i, dphi))
        self.sin_o = np.sqrt(np.maximum(0.0, 1.0 - self.mu_o**2))
        self.sin_i = np.sqrt(np.maximum(0.0, 1.0 - self.mu_i**2))
        self.light_x = -self.sin_i * np.cos(dphi)
        self.light_y = -self.sin_i * np.sin(dphi)
        self.light_z = -self.mu_i if below else self.mu_i

    @functools.cached_property
    def cos_between(self):
        """Cosine between viewer and light."""
        return self.sin_o * self.light_x + self.mu_o * self.light_z

    def cos_half(self):
        """Cosine between the half vector and either direction."""
        return np.sqrt(np.maximum(0.0, 0.5 * (1.0 + self.cos_between)))

    def along(self, normal: Normal):
        """Cosine of the light with a (possibly tilted) normal, which lies in the plane of incidence."""
        x, z = self.normal(normal)
        return x * self.light_x + z * self.light_z

    def normal(self, normal: Normal):
        """The (x, z) components of a named normal; see `NodeRecipe`."""
        if normal == "N":
            return np.zeros_like(self.mu_o), np.ones_like(self.mu_o)
        if normal == "I":
            return self.sin_o, self.mu_o
        if normal == "N+I":
            return np.sqrt(0.5 * (1.0 - self.mu_o)), np.sqrt(0.5 * (1.0 + self.mu_o))
        if isinstance(normal, tuple) and normal[0] == "lean":
            length = np.sqrt(self.sin_o**2 + (self.mu_o + normal[1]) ** 2)
            return -self.sin_o / length, (self.mu_o + normal[1]) / length
        if isinstance(normal, tuple) and normal[0] == "tilt":
            angle = np.radians(normal[1])
            return np.full_like(self.mu_o, np.sin(angle)), np.full_like(self.mu_o, np.cos(angle))
        raise ValueError(f"normal = {normal!r}: must be 'N', 'I', 'N+I', ('lean', share) or ('tilt', degrees)")


def number(x: float) -> str:
    """A number as part of an id."""
    return f"{x:g}".replace(".", "").replace("-", "m")
