# SPDX-License-Identifier: GPL-3.0-or-later
"""The slab scene's radiance from the exact scattering function: no Monte Carlo, no fit."""

import math

import numpy as np

from . import light, view

_AZIMUTHS = 32
_COSINES = 64
_VIEWS = 128
_FLATTEST = 0.01


def picture(scattering, size, subdivide=1):
    """The camera's picture of the slab, (size, size, 3), first row on top; undefined outside the region.

    scattering: lamina.solve's ScatteringFunction of the stack. Each pixel is the mean of `subdivide` x `subdivide`
    rays; more than one matters only for coarse pictures.
    """
    rays = view.pixels(size * subdivide)
    fine = radiance(scattering, np.clip(rays.mu_o, _FLATTEST, 1.0), rays.dphi)
    return fine.reshape(size, subdivide, size, subdivide, 3).mean(axis=(1, 3))


def radiance(scattering, mu_o, dphi):
    """Radiance that leaves the slab under sun and sky; dphi against the sun's light, 0 = forward."""
    mu_sun = math.sin(light.SUN_ELEVATION)
    sun = _rgb(scattering.brdf(mu_o, mu_sun, dphi)) * mu_sun * np.array(light.SUN_IRRADIANCE)
    # The sky does not depend on azimuth, so its contribution is a smooth function of the view cosine only.
    views = np.linspace(mu_o.min(), mu_o.max(), _VIEWS)
    sky = _under_sky(scattering, views)
    return sun + np.stack([np.interp(mu_o, views, sky[:, k]) for k in range(3)], axis=-1)


def _under_sky(scattering, views):
    """int f(mu_o, w) mu L(mu) dw over the upper hemisphere, shape (views, 3)."""
    nodes, weights = np.polynomial.legendre.leggauss(_COSINES)
    root, weights = (nodes + 1.0) / 2.0, weights / 2.0
    # mu = root^2 puts more nodes at grazing light, where the sky is brightest and f steep.
    mu, weights = root**2, weights * 2.0 * root
    azimuth = (np.arange(_AZIMUTHS) + 0.5) * math.pi / _AZIMUTHS
    result = np.zeros((len(views), 3))
    for node, weight in zip(mu, weights, strict=True):
        f = _rgb(scattering.brdf(views[:, None], node, azimuth[None, :])).mean(axis=1)
        result += 2.0 * math.pi * weight * node * f * light.sky_radiance(node)
    return result


def _rgb(values):
    return np.broadcast_to(values, (*np.shape(values)[:-1], 3))
