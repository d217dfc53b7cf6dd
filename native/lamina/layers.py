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


@dataclass(frozen=True)
class Lambert:
    """An ideally diffuse surface of the given reflectance, [0, 1]."""

    reflectance: Channels

    kind = "lambert"
    fields = (Field("reflectance", 0.0, 1.0, UNIT),)


@dataclass(frozen=True)
class Black:
    """Absorbs all that reaches it."""

    kind = "black"
    fields = ()


@dataclass(frozen=True)
class HalfSpace:
    """A medium without end."""

    albedo: Channels
    phase: Phase = field(default_factory=Isotropic)

    kind = "half-space"
    fields = (Field("albedo", 0.0, 1.0, UNIT),)


BASES = {cls.kind: cls for cls in (Lambert, Black, HalfSpace)}
Base = Lambert | Black | HalfSpace
