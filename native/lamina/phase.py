# SPDX-License-Identifier: GPL-3.0-or-later
"""Phase functions: how a medium turns light. The core evaluates them; here they are named and described."""

from __future__ import annotations

from dataclasses import dataclass

from .fields import Channels, Field


@dataclass(frozen=True)
class Isotropic:
    """Equal scattering into all directions."""

    kind = "isotropic"
    fields = ()


@dataclass(frozen=True)
class HenyeyGreenstein:
    """Henyey and Greenstein (1941). `g`, the mean cosine, in (-1, 1), a number or one a channel."""

    g: Channels

    kind = "hg"
    fields = (Field("g", -1.0, 1.0, "must lie in (-1, 1)", open_ended=True),)


@dataclass(frozen=True)
class Rayleigh:
    """Scattering by particles much smaller than the wavelength, unpolarised: 3/4 (1 + cos^2)."""

    kind = "rayleigh"
    fields = ()


PHASES = {cls.kind: cls for cls in (Isotropic, HenyeyGreenstein, Rayleigh)}
Phase = Isotropic | HenyeyGreenstein | Rayleigh
