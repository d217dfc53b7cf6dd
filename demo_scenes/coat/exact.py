# SPDX-License-Identifier: GPL-3.0-or-later
"""Radiance of the coat under its sky from the scattering function: no Monte Carlo, no fit."""

import math

import numpy as np

from . import light


def radiance(scattering, mu_o, azimuth):
    """Radiance towards viewers at the cosines `mu_o`, shape (n, 3), under sky and cap.

    azimuth: in radians, (n,), from the view direction to the direction of the cap; 0: the cap is straight ahead."""
    mu_o, azimuth = np.asarray(mu_o, float), np.asarray(azimuth, float)
    up, aside, solid_angle = light.cap_rule()
    # Light from straight ahead travels towards the viewer and keeps its azimuth.
    dphi = azimuth[:, None] + aside
    f = np.broadcast_to(scattering.brdf(mu_o[:, None], up, dphi), (*dphi.shape, 3))
    from_cap = np.einsum("vlc,l->vc", f, solid_angle * up)
    scattered, mirrored = scattering.reflectance(mu_o, parts=True)
    elevation = np.arcsin(mu_o)
    # Seen in the mirror direction, the ray leaves ahead, at the elevation of the viewer.
    cosine = (np.sin(elevation) * math.sin(light.CAP_ELEVATION)
              + np.cos(elevation) * math.cos(light.CAP_ELEVATION) * np.cos(azimuth))
    mirror = np.where(cosine > math.cos(light.CAP_RADIUS), light.CAP, light.SKY)
    return light.SKY * scattered + (light.CAP - light.SKY) * from_cap + mirror[:, None] * mirrored
