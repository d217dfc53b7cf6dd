# SPDX-License-Identifier: GPL-3.0-or-later
"""What a stack is made of: media, and the bases that they lie on."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from .fields import Channels, Field
from .phase import Isotropic, Phase

UNIT = "must lie in [0, 1]"
NOT_NEGATIVE = "must lie in [0, infinity]"


@dataclass(frozen=True)
class Medium:
    """A homogeneous scattering layer. Every quantity is a number or one a channel.

    Either `albedo` (single scattering, sigma_s / sigma_t, in [0, 1]) and `tau` (optical thickness, from 0
    to infinity), or `sigma_s`, `sigma_a` (1/mm) and `thickness` (mm). `varying` marks the one layer whose
    thickness becomes an input of the baked material; its tau is then the largest thickness. Values are
    checked when the layer becomes part of a Stack."""

    albedo: Channels | None = None
    tau: Channels | None = None
    phase: Phase = field(default_factory=Isotropic)
    sigma_s: Channels | None = None
    sigma_a: Channels | None = None
    thickness: Channels | None = None
    name: str = ""
    varying: bool = False

    kind = "medium"
    forms = (
        (Field("albedo", 0.0, 1.0, UNIT), Field("tau", 0.0, math.inf, NOT_NEGATIVE, infinite=True)),
        (
            Field("sigma_s", 0.0, 1e12, "must lie in [0, 1e12] 1/mm"),
            Field("sigma_a", 0.0, 1e12, "must lie in [0, 1e12] 1/mm"),
            Field("thickness", 0.0, math.inf, "must lie in [0, infinity] mm", infinite=True),
        ),
    )


DISTRIBUTIONS = ("ggx", "beckmann")


@dataclass(frozen=True)
class Interface:
    """A boundary between two dielectrics. `ior`: absolute refractive index of all that lies below it, down to
    the next interface, [1, 4]; above the first one is air, and a sheet seen from both sides ends with one of
    ior 1. `alpha`: microfacet width, [0, 1], 0 is smooth. `compensate`: give back the energy that facets
    which scatter once lose to shadowing. `correlated`: height-correlated masking, else the product of both
    directions' (the older form that some renderers use)."""

    ior: Channels
    alpha: float = 0.0
    distribution: str = "ggx"
    compensate: bool = True
    correlated: bool = True
    name: str = ""

    kind = "interface"
    fields = (Field("ior", 1.0, 4.0, "must lie in [1, 4]"), Field("alpha", 0.0, 1.0, UNIT))
    choices = {"distribution": DISTRIBUTIONS, "compensate": (True, False), "correlated": (True, False)}
    varying = False


@dataclass(frozen=True)
class Conductor:
    """A metal of complex refractive index `eta` + i `k` (one a channel); facets as of an Interface."""

    eta: Channels
    k: Channels
    alpha: float = 0.0
    distribution: str = "ggx"
    compensate: bool = True
    correlated: bool = True

    kind = "conductor"
    fields = (
        Field("eta", 1e-3, 100.0, "must lie in [0.001, 100]"),
        Field("k", 0.0, 100.0, "must lie in [0, 100]"),
        Field("alpha", 0.0, 1.0, UNIT),
    )
    choices = Interface.choices


@dataclass(frozen=True)
class Lambert:
    """An ideally diffuse surface of the given reflectance, [0, 1]. `textured`: the baked material takes it as an
    input, of which this is the usual value."""

    reflectance: Channels
    textured: bool = False

    kind = "lambert"
    fields = (Field("reflectance", 0.0, 1.0, UNIT),)
    choices = {"textured": (False, True)}


@dataclass(frozen=True)
class Black:
    """Absorbs all that reaches it."""

    kind = "black"
    fields = ()
    choices = {}


@dataclass(frozen=True)
class HalfSpace:
    """A medium without end."""

    albedo: Channels
    phase: Phase = field(default_factory=Isotropic)

    kind = "half-space"
    fields = (Field("albedo", 0.0, 1.0, UNIT),)
    choices = {}


BASES = {cls.kind: cls for cls in (Lambert, Black, HalfSpace, Conductor)}
Base = Lambert | Black | HalfSpace | Conductor
