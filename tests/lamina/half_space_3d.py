# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact reflection of a pencil beam along the normal by an isotropic half-space with matched index: the
H function at a lateral frequency, from H_q(u) = exp(-(u/pi) int_0^inf ln(1 - a atan(K)/K) / (1 + u^2 k^2) dk),
K^2 = k^2 + q^2. Lengths in mean free paths."""

import numpy as np

_T = np.linspace(-4.5, 4.5, 801)
_K = np.exp(0.5 * np.pi * np.sinh(_T))
_WEIGHT = (_T[1] - _T[0]) * _K * 0.5 * np.pi * np.cosh(_T)


def h_function(q: float, u, albedo: float) -> np.ndarray:
    u = np.atleast_1d(u)[:, None]
    k = np.hypot(_K, q)
    logarithm = np.log1p(-albedo * np.arctan(k) / k) * _WEIGHT
    return np.exp(-u[:, 0] / np.pi * (logarithm / (1.0 + (u * _K) ** 2)).sum(axis=1))


def reflected_at(q: float, albedo: float) -> float:
    """The integral of the flux density times J0(q r)."""
    x, weight = np.polynomial.legendre.leggauss(200)
    x, weight = 0.5 * (x + 1.0), 0.5 * weight
    s = np.sqrt(1.0 / x**2 + q * q)
    return 0.5 * albedo * h_function(q, 1.0, albedo)[0] * np.sum(weight * h_function(q, 1.0 / s, albedo) / (1.0 + s))


def mean_square_distance(albedo: float, step: float = 0.02) -> float:
    """From J0(q r) = 1 - (q r)^2 / 4 + ..., by differences of three frequencies."""
    flux, near, far = (reflected_at(q, albedo) for q in (1e-9, step, 2.0 * step))
    slope = (4.0 * (flux - near) - 0.25 * (flux - far)) / 3.0
    return 4.0 * slope / (step * step) / flux
