# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact light of a pencil beam on an isotropic half-space of matched index, at normal incidence, for sigma_t = 1/mm.

From the H-function at one lateral frequency q,
    H_q(u) = exp(-(u/pi) int_0^inf ln(1 - a atan(K)/K) / (1 + u^2 k^2) dk),  K^2 = k^2 + q^2,
the reflected flux density's integral times J0(q r) is
    R(q) = (a/2) H_q(1) int_0^1 H_q(1/s) / (1 + s) dx,  s = sqrt(1/x^2 + q^2)."""

import numpy as np


def _rule(count):
    """Gauss-Legendre nodes on [0, 1], crowded at both ends."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    x = 0.5 * (nodes + 1.0)
    # x -> x^3 (10 - 15 x + 6 x^2): smooth, flat at both ends.
    return x**3 * (10.0 - 15.0 * x + 6.0 * x * x), 0.5 * weights * 30.0 * (x * (1.0 - x)) ** 2


def _h(albedo, q, u, count=200):
    """H_q for an array of u in (0, 1]."""
    t, weight = _rule(count)
    k, dk = t / (1.0 - t), weight / (1.0 - t) ** 2
    big = np.sqrt(k * k + q * q)
    log = np.log1p(-albedo * np.arctan(big) / big)
    return np.exp(-u / np.pi * ((dk * log) / (1.0 + np.square(np.outer(u, k)))).sum(axis=1))


def reflected_at(albedo, q):
    """R(q), one number for each q; the flux itself at q = 0."""
    x, weight = _rule(50)
    values = []
    for one in np.atleast_1d(q):
        one = max(float(one), 1e-9)
        s = np.sqrt(1.0 / x**2 + one * one)
        inner = (weight * _h(albedo, one, 1.0 / s) / (1.0 + s)).sum()
        values.append(0.5 * albedo * _h(albedo, one, np.array([1.0]))[0] * inner)
    return np.array(values)


def mean_distance(albedo):
    """From r = int_0^inf (1 - J0(q r)) / q^2 dq."""
    t, weight = _rule(80)
    q, dq = t / (1.0 - t), weight / (1.0 - t) ** 2
    flux = reflected_at(albedo, 0.0)[0]
    return float((dq * (flux - reflected_at(albedo, q)) / (q * q)).sum() / flux)


def mean_square_distance(albedo, step=0.02):
    """From J0(q r) = 1 - (q r)^2 / 4 + ..., by differences of three frequencies."""
    flux, near, far = reflected_at(albedo, [0.0, step, 2.0 * step])
    slope = (4.0 * (flux - near) - 0.25 * (flux - far)) / 3.0
    return float(4.0 * slope / (step * step) / flux)
