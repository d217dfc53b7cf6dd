# SPDX-License-Identifier: GPL-3.0-or-later
"""Boundaries between dielectrics, and the facets of rough surfaces."""

from __future__ import annotations

import math
from dataclasses import dataclass

from .fields import Channels, Field, Option, Rare
from .hashable import Hashable
from .panel import Item, Panel

ALPHA = Field("alpha", 0.0, 1.0, single=True, panel=Panel(
    "Alpha", "Microfacet width: roughness squared", 0.0, step=1, precision=4,
    words="microfacet width (roughness squared)"))
IOR = Field("ior", 1.0, 4.0, panel=Panel(
    "IOR", "Refractive index of all that lies below, down to the next interface", 1.5, step=1, precision=3,
    words="IOR"))
DISTRIBUTION = Option("distribution", ("ggx", "beckmann"), "Distribution", "How the slopes of the facets are spread", (
    Item("ggx", "GGX", "Facets with a narrow peak and long tails: most real surfaces", 0),
    Item("beckmann", "Beckmann", "Facets without tails: ground glass, some varnishes", 1)))
COMPENSATE = Option("compensate", (True, False), "Keep Energy",
                    "Give back the light that facets which scatter it only once would lose")
CORRELATED = Option("correlated", (True, False), "Shared Shadows",
                    "Facets hidden from one side are more often hidden from the other too")
FACETS = (DISTRIBUTION, COMPENSATE, CORRELATED)
# Facets with a direction
ALPHA_V = Field("alpha_v", 0.0, 1.0, above=True, single=True, panel=Panel(
    "Alpha Across", "Microfacet width across the direction of brushing: roughness squared", 0.09, low=1e-4, step=1,
    precision=4, words="microfacet width across (roughness squared)"))
ANGLE = Field("angle", -2.0 * math.pi, 2.0 * math.pi, "rad", single=True, rule="must lie in [-2 pi, 2 pi] rad",
              panel=Panel("Angle", "Turns the direction of brushing from the tangent, about the normal", 0.0,
                          subtype="ANGLE"))
ORIENTATION = (Rare(ALPHA_V, None), Rare(ANGLE, 0.0))
VARYING = Option("varying", (False, True), "Varying",
                 "Give the node group a Coverage input: 0 without the film of this interface, 1 with it")


@dataclass(frozen=True)
class Interface(Hashable):
    """A boundary between two dielectrics. `ior`: absolute refractive index of everything below it, down to the next
    interface, [1, 4]; above the first interface is air, and a sheet seen from both sides ends with an interface of ior
    1. `alpha`: microfacet width, [0, 1], 0 is smooth. `compensate`: add the energy that single scattering by facets
    loses to shadowing, refracted light in its own direction. `correlated`: height-correlated masking, else the product
    of the masking of both directions (the older form that some renderers use).

    `alpha_v` makes the facets anisotropic, as brushing does: `alpha` is then the width along the surface's tangent, and
    `alpha_v`, in (0, 1], the width across. `angle`, in [-2 pi, 2 pi], turns the tangent of this interface about the
    normal, in radians. None: the same width in all directions. lamina.solve, lamina.estimate and lamina.bake take
    anisotropic facets.

    `varying` marks the one interface whose coverage becomes an input of the baked material: the share of the surface
    that has its film, which is the interface and the media below it, down to the next interface or the base. Where the
    film is absent, what lies below meets the index above the film. Solvers take the film as present."""

    ior: Channels
    alpha: float = 0.0
    distribution: str = "ggx"
    compensate: bool = True
    correlated: bool = True
    name: str = ""
    varying: bool = False
    alpha_v: float | None = None
    angle: float = 0.0

    kind = "interface"
    fields = (IOR, ALPHA)
    options = (*FACETS, VARYING)
    rare = ORIENTATION
    has_phase = False
    item = Item(kind, "Interface", "A boundary that reflects and refracts: the surface of varnish, glass, water", 1,
                icon="MESH_PLANE")


def is_oriented(surface) -> bool:
    """True for a surface with anisotropic facets."""
    return getattr(surface, "alpha_v", None) not in (None, getattr(surface, "alpha", None))
