# SPDX-License-Identifier: GPL-3.0-or-later
"""Single scattering in a deep medium: light that enters, is scattered once, and leaves."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..common.by_content import ByContent
from ..kinds.bases import HalfSpace
from ..kinds.fields import channel
from ..kinds.phases import HenyeyGreenstein, Isotropic
from ..material.layers import Medium
from ..material.millimetres import sigma_t
from ..material.stack import Stack

# From this optical thickness on, single scattering of a layer equals that of a half-space within 1e-4.
DEEP = 4.5
NODES, TURNS = 64, 256  # quadrature: cosines, and azimuths over half a turn
_COSINES, _WEIGHTS = (0.5 * part for part in np.polynomial.legendre.leggauss(NODES))
_COSINES = _COSINES + 0.5
_AZIMUTH_COSINES = np.cos(math.pi * (np.arange(TURNS) + 0.5) / TURNS)


@dataclass(frozen=True, eq=False)
class SingleScattering(ByContent):
    """A deep medium with the phase function of Henyey and Greenstein. `sigma_s`, `sigma_a`: coefficients by channel,
    1/mm, shape (channels,); `g`: mean cosine of all channels."""

    sigma_s: np.ndarray
    sigma_a: np.ndarray
    g: float

    @property
    def extinction(self) -> np.ndarray:
        """Extinction by channel, 1/mm."""
        return self.sigma_s + self.sigma_a

    def density(self, r: np.ndarray, index: int) -> np.ndarray:
        """Flux density in one channel at the distances `r`, mm, from a beam along the normal with unit flux, 1/mm^2."""
        sigma = self.extinction[index]
        return sigma**2 * flux_density(r * sigma, self.sigma_s[index] / sigma, self.g)

    def reflectance(self, mu: np.ndarray) -> np.ndarray:
        """Reflected flux for a beam at the cosines `mu`, shape (n,); result of shape (n, channels)."""
        return reflected_share(mu, self.g)[:, None] * (self.sigma_s / self.extinction)


def of_stack(stack: Stack) -> SingleScattering | None:
    """Single scattering of the topmost medium. None if the stack begins with a boundary, or if the medium is shallower
    than DEEP, has a profile, or has no single mean cosine of Henyey and Greenstein's phase function."""
    top = stack.layers[0] if stack.layers else stack.base
    if not isinstance(top, Medium | HalfSpace) or not isinstance(top.phase, Isotropic | HenyeyGreenstein):
        return None
    if isinstance(top, Medium) and (top.profile is not None or top.thickness is None):
        return None
    channels = range(stack.channels)
    if isinstance(top, Medium) and min(stack.optics(0, c)[1] for c in channels) < DEEP:
        return None
    cosines = {0.0 if isinstance(top.phase, Isotropic) else float(channel(top.phase.g, c)) for c in channels}
    total = np.array([sigma_t(top, c) for c in channels])
    scattered = np.array([float(channel(top.sigma_s, c)) for c in channels])
    if len(cosines) > 1 or not np.all(scattered > 0.0):
        return None
    return SingleScattering(scattered, total - scattered, cosines.pop())


def henyey_greenstein(cosine, g: float):
    """Phase function times 4 pi, at the cosine of the angle by which light turns."""
    return (1.0 - g * g) / (1.0 + g * g - 2.0 * g * cosine) ** 1.5


def flux_density(r: np.ndarray, albedo: float, g: float = 0.0) -> np.ndarray:
    """Flux density at the distance r, in mean free paths, for a beam along the normal:
    albedo int p(-z / d) exp(-z - d) z / d^3 dz, where d^2 = r^2 + z^2."""
    angle = 0.5 * math.pi * _COSINES  # z = r tan(angle)
    z, d = r[:, None] * np.tan(angle), r[:, None] / np.cos(angle)
    upwards = np.sin(angle) * henyey_greenstein(-np.sin(angle), g)
    return albedo / (4.0 * math.pi * r) * ((np.exp(-z - d) * upwards) @ (0.5 * math.pi * _WEIGHTS))


def reflected_share(mu: np.ndarray, g: float = 0.0) -> np.ndarray:
    """Reflected flux of a half-space of albedo 1, by the cosine of entry: 1/2 int p(mu, mu') mu' / (mu + mu') dmu',
    where p is the mean of the phase function over azimuths."""
    sines, found = np.sqrt(1.0 - _COSINES**2), np.empty(len(mu))
    for k, cosine in enumerate(mu):
        across = math.sqrt(max(1.0 - cosine * cosine, 0.0)) * sines
        turned = -cosine * _COSINES[:, None] + across[:, None] * _AZIMUTH_COSINES
        mean = henyey_greenstein(turned, g).mean(axis=1)
        found[k] = 0.5 * np.sum(_WEIGHTS * mean * _COSINES / (cosine + _COSINES))
    return found
