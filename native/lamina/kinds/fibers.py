# SPDX-License-Identifier: GPL-3.0-or-later
"""Fibers: layers of fuzz, such as velvet, moss, peach skin, fluff."""

from __future__ import annotations

import math
from dataclasses import dataclass

from .fields import Channels, Field, channel
from .flakes import VARYING
from .hashable import Hashable
from .panel import Item, Panel

AMOUNT = Field("tau", 0.0, 1e3, panel=Panel(
    "Amount", "Area of the fibers, each seen from its side, per area of surface: 0.1 is a haze, 1 hides most of what "
    "is below at grazing views, 5 is dense", 1.0, soft_high=5.0, step=10, precision=3, words="amount of fibers",
    prop="fiber_tau"))
LEAN = Field("tilt", 0.05, 0.5 * math.pi, "rad", single=True, rule="must lie in [.05, pi / 2] rad", panel=Panel(
    "Lean", "Angle of the fibers from upright: small for velvet, 90 degrees for fluff that lies flat", 0.35,
    subtype="ANGLE", words="lean of fibers", prop="fiber_tilt"))
COLOUR = Field("reflectance", 0.0, 1.0, panel=Panel(
    "Fiber Color", "Share of the light that a fiber scatters, per channel", (0.5, 0.02, 0.03), rgb=True,
    subtype="COLOR", words="color of fibers", prop="fiber_reflectance"))
TRANSLUCENCY = Field("translucency", 0.0, 1.0, single=True, panel=Panel(
    "Translucency", "Share of the scattered light that passes through a fiber: 0 is opaque, 0.5 is fine hair", 0.3,
    step=1, precision=3, words="translucency of fibers", prop="fiber_translucency"))


@dataclass(frozen=True)
class Fibers(Hashable):
    """A layer of matte fibers, thin cylinders of random azimuth, between which light is scattered any number of times.

    `tau`: the area of the fibers, each seen from its side, per area of surface: number per area times length times
    diameter, [0, 1000]. `tilt`: the angle between fibers and the layer's normal in radians, [.05, pi / 2], one number:
    small for velvet, pi / 2 for fluff that lies flat. `reflectance`: the share of the light that a fiber scatters, in
    [0, 1]. `translucency`: the share of this light that leaves the fiber on its other side, [0, 1], one number; on
    either side, light leaves by Lambert's cosine law. Quantities are numbers or one per channel. `varying` marks the
    one layer whose thickness becomes an input of the baked material: `tau` is then the largest one.

    Along a ray, the optical thickness is tau times the mean area that a fiber shows. Along the normal this area is
    sin(tilt), along the layer (2 / pi) E(sin^2 tilt), with the complete elliptic integral. Between both, the area and
    the normals of the sides are those of SGGX. Source: Heitz, Dupuy, Crassin and Dachsbacher 2015, "The SGGX microflake
    distribution", with diffuse flakes; transmission as in Lambertian leaves."""

    tau: Channels
    tilt: float
    reflectance: Channels
    translucency: float = 0.0
    name: str = ""
    varying: bool = False

    kind = "fibers"
    fields = (AMOUNT, LEAN, COLOUR, TRANSLUCENCY)
    options = (VARYING,)
    rare = ()
    has_phase = False
    item = Item(kind, "Fibers", "Fuzz: velvet, moss, peach skin, fluff", 4, icon="STRANDS")

    @property
    def seen_from_above(self) -> float:
        """The area that a fiber shows along the normal, relative to that from its side."""
        return math.sin(self.tilt)

    @property
    def alpha(self) -> float:
        """The area that the fibers show along the layer, relative to that along the normal."""
        steps = 64  # the trapezoidal rule of a periodic function
        square = math.sin(self.tilt) ** 2
        along = sum(math.sqrt(1.0 - square * math.cos(math.pi * k / steps) ** 2) for k in range(steps)) / steps
        return along / self.seen_from_above

    def optics(self, index: int) -> tuple[float, float]:
        """(albedo, tau) of one channel along the normal."""
        return channel(self.reflectance, index), channel(self.tau, index) * self.seen_from_above

