# SPDX-License-Identifier: GPL-3.0-or-later
"""What a stack is made of: media, and the bases that they lie on."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from .errors import StackError, shown
from .fields import Channels, Field, channel, check_forms
from .phase import Isotropic, Phase, check_phase
from .profile import (
    ALBEDO,
    COLOR,
    OVER,
    SIGMA_A,
    SIGMA_S,
    UNIT,
    Knot,
    check_profile,
    optical_thickness,
    turned,
)

TAU = Field("tau", 0.0, math.inf, "must lie in [0, infinity]", infinite=True)


@dataclass(frozen=True)
class Medium:
    """A scattering layer, homogeneous unless it has a `profile`. Every quantity is a number or one a channel.

    Either `albedo` (single scattering, sigma_s / sigma_t, in [0, 1]) and `tau` (optical thickness, from 0
    to infinity), or `sigma_s`, `sigma_a` (1/mm) and `thickness` (mm), or `color` and `tau`. `color`, in
    [0, 1], is what the medium shows, without interfaces, under a white sky: the share of uniform diffuse
    light that it returns as a layer without end, or, when `over` is given, as a layer of its own tau on a
    Lambert surface of that reflectance. The stack finds the albedo that shows it. `varying` marks the one
    layer whose thickness becomes an input of the baked material; its tau is then the largest thickness, and
    the one that shows the colour. Or `profile`, two knots or more from top to bottom, and `tau` or `thickness`,
    both finite: see Knot. Values are checked when the layer becomes part of a Stack."""

    albedo: Channels | None = None
    tau: Channels | None = None
    phase: Phase = field(default_factory=Isotropic)
    sigma_s: Channels | None = None
    sigma_a: Channels | None = None
    thickness: Channels | None = None
    name: str = ""
    varying: bool = False
    color: Channels | None = None
    over: Channels | None = None
    profile: Sequence[Knot] | None = None

    kind = "medium"
    forms = (
        (ALBEDO, TAU),
        (SIGMA_S, SIGMA_A, Field("thickness", 0.0, math.inf, "must lie in [0, infinity] mm", infinite=True)),
        (COLOR, OVER, TAU),
    )
    fields = ()

    def checked(self, path: str) -> Medium:
        """Itself with every quantity as floats. Raises StackError, with the quantity's path."""
        values = check_forms(self, path) if self.profile is None else check_profile(self, path)
        if not isinstance(self.varying, bool):
            raise StackError(f"{path}.varying = {shown(self.varying)}: must be true or false")
        return replace(self, phase=check_phase(self.phase, f"{path}.phase"), **values)

    def optics(self, index: int) -> tuple[float | None, float]:
        """(albedo, tau) of one channel; the albedo is None where a colour or a profile says it."""
        if self.profile is not None:
            return None, optical_thickness(self, index)
        if self.tau is not None:
            return None if self.albedo is None else channel(self.albedo, index), channel(self.tau, index)
        sigma_s = channel(self.sigma_s, index)
        sigma_t = sigma_s + channel(self.sigma_a, index)
        if sigma_t == 0.0:
            return 0.0, 0.0
        return sigma_s / sigma_t, sigma_t * channel(self.thickness, index)

    def turned(self) -> Medium:
        """The layer upside down."""
        return self if self.profile is None else replace(self, profile=turned(self.profile))


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
    """A metal: its complex refractive index `eta` + i `k`, or the two colours from which the stack finds it,
    `facing`, the reflectance at normal incidence, and `grazing`, that at 82 degrees from the normal, both in
    [0, 1] and in air. Numbers, or one a channel; facets as of an Interface."""

    eta: Channels | None = None
    k: Channels | None = None
    alpha: float = 0.0
    distribution: str = "ggx"
    compensate: bool = True
    correlated: bool = True
    facing: Channels | None = None
    grazing: Channels | None = None

    kind = "conductor"
    forms = (
        (Field("eta", 1e-3, 100.0, "must lie in [0.001, 100]"), Field("k", 0.0, 100.0, "must lie in [0, 100]")),
        (Field("facing", 0.0, 1.0, UNIT), Field("grazing", 0.0, 1.0, UNIT)),
    )
    fields = (Field("alpha", 0.0, 1.0, UNIT),)
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
    """A medium without end, given by its `albedo`, or by `sigma_s` and `sigma_a` (1/mm), which say how far light gets
    in it as well. Numbers, or one a channel."""

    albedo: Channels | None = None
    phase: Phase = field(default_factory=Isotropic)
    sigma_s: Channels | None = None
    sigma_a: Channels | None = None

    kind = "half-space"
    forms = ((ALBEDO,), (SIGMA_S, SIGMA_A))
    fields = ()
    choices = {}

    def albedo_of(self, index: int) -> float:
        """The albedo of one channel."""
        if self.albedo is not None:
            return channel(self.albedo, index)
        sigma_s = channel(self.sigma_s, index)
        sigma_t = sigma_s + channel(self.sigma_a, index)
        return sigma_s / sigma_t if sigma_t > 0.0 else 0.0


BASES = {cls.kind: cls for cls in (Lambert, Black, HalfSpace, Conductor)}
Base = Lambert | Black | HalfSpace | Conductor
