# SPDX-License-Identifier: GPL-3.0-or-later
"""Media, the scattering layers of a stack."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from ..common.errors import StackError, quoted
from ..kinds.fields import Channels, channel, check_forms
from ..kinds.hashable import Hashable
from ..kinds.media import BY_ALBEDO, BY_COEFFICIENTS, BY_COLOUR, BY_PIGMENT, ITEM, single_scattering_albedo
from ..kinds.phases import Isotropic
from .phase import Phase, check_phase
from .profile import Knot, check_profile, tau_of, turned


@dataclass(frozen=True)
class Medium(Hashable):
    """A scattering layer, homogeneous unless it has a `profile`. Every quantity is a number or one per channel.

    Either `albedo` (single scattering, sigma_s / sigma_t, in [0, 1]) and `tau` (optical thickness, from 0
    to infinity), or `sigma_s`, `sigma_a` (1/mm) and `thickness` (mm), or `color` and `tau`. `color`, in [0, 1], is the
    medium's reflectance for uniform diffuse light, without interfaces: of an infinitely thick layer, or, with `over`,
    of a layer of its own tau on a Lambert surface of that reflectance. The stack finds the albedo that gives this
    colour. Or `pigment`, a name of lamina.pigments, its `amount`, `sigma_s` and `thickness`: the absorption is the
    published spectrum, and the stack has wavelengths. Or `profile`, two or more knots from top to bottom, and `tau` or
    `thickness`, both finite: see Knot.

    `varying` marks the one layer whose thickness becomes an input of the baked material. Its tau is then the largest
    thickness, for which the colour is meant. Values are checked when the layer becomes part of a Stack."""

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
    pigment: str | None = None
    amount: float | None = None
    profile: Sequence[Knot] | None = None

    kind = ITEM.id
    forms = (BY_ALBEDO, BY_COEFFICIENTS, BY_COLOUR, BY_PIGMENT)
    fields = ()

    def checked(self, path: str) -> Medium:
        """A copy with every quantity as floats. Raises StackError, with the quantity's path."""
        values = check_forms(self, path) if self.profile is None else check_profile(self, path)
        if not isinstance(self.varying, bool):
            raise StackError(f"{path}.varying = {quoted(self.varying)}: must be true or false")
        return replace(self, phase=check_phase(self.phase, f"{path}.phase"), **values)

    def optics(self, index: int) -> tuple[float | None, float]:
        """(albedo, tau) of one channel; the albedo is None if a colour or a profile is given instead."""
        if self.profile is not None:
            return None, tau_of(self, index)
        if self.tau is not None:
            return None if self.albedo is None else channel(self.albedo, index), channel(self.tau, index)
        sigma_s, sigma_a = channel(self.sigma_s, index), channel(self.sigma_a, index)
        sigma_t = sigma_s + sigma_a
        tau = sigma_t * channel(self.thickness, index) if sigma_t > 0.0 else 0.0
        return single_scattering_albedo(sigma_s, sigma_a), tau

    def turned(self) -> Medium:
        """The layer upside down."""
        return self if self.profile is None else replace(self, profile=turned(self.profile))
