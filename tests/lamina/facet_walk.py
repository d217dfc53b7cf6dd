# SPDX-License-Identifier: GPL-3.0-or-later
"""A photon walk through a rough GGX boundary over a Henyey-Greenstein medium over a Lambert surface, independent of the
solver's code: facets are sampled by their density, and scatter once."""

import numpy as np


def _lambda(mu, alpha):
    return 0.5 * (np.sqrt(1.0 + alpha**2 * (1.0 / mu**2 - 1.0)) - 1.0)


def _facets(rng, towards, ratio, alpha):
    """One meeting with the boundary. `towards` points back along the ray, z on its own side; returns the new
    direction in the same frame and its weight (Walter et al. 2007, eq. 41, height-correlated masking)."""
    u, phi = rng.random(len(towards)), 2.0 * np.pi * rng.random(len(towards))
    tangent = alpha * np.sqrt(u / (1.0 - u))
    z = 1.0 / np.sqrt(1.0 + tangent**2)
    h = np.stack([tangent * z * np.cos(phi), tangent * z * np.sin(phi), z], axis=1)
    c = np.einsum("ij,ij->i", towards, h)
    refracted = np.sqrt(np.maximum(0.0, 1.0 - (1.0 - c**2) / ratio**2))
    s = (c - ratio * refracted) / (c + ratio * refracted)
    p = (ratio * c - refracted) / (ratio * c + refracted)
    back = np.where(refracted > 0.0, 0.5 * (s**2 + p**2), 1.0)
    reflected = rng.random(len(c)) < back
    mirror = 2.0 * c[:, None] * h - towards
    through = (c / ratio - refracted)[:, None] * h - towards / ratio
    leaving = np.where(reflected[:, None], mirror, through)
    possible = (c > 0.0) & (np.where(reflected, leaving[:, 2], -leaving[:, 2]) > 1e-9)
    out = np.maximum(np.abs(leaving[:, 2]), 1e-9)
    masking = 1.0 / (1.0 + _lambda(towards[:, 2], alpha) + _lambda(out, alpha))
    return leaving, np.where(possible, masking * c / (towards[:, 2] * z), 0.0), reflected


def _turned(rng, direction, g):
    """Henyey-Greenstein's deflection; z of all directions stays away from +-1 almost surely."""
    u, phi = rng.random(len(direction)), 2.0 * np.pi * rng.random(len(direction))
    cosine = (1.0 + g**2 - ((1.0 - g**2) / (1.0 - g + 2.0 * g * u)) ** 2) / (2.0 * g)
    sine = np.sqrt(np.maximum(0.0, 1.0 - cosine**2))
    x, y, z = direction.T
    across = np.sqrt(np.maximum(1.0 - z**2, 1e-18))
    return np.stack([
        sine * (x * z * np.cos(phi) - y * np.sin(phi)) / across + x * cosine,
        sine * (y * z * np.cos(phi) + x * np.sin(phi)) / across + y * cosine,
        -sine * np.cos(phi) * across + z * cosine], axis=1)


def reflectance(mu0, *, ior, alpha, albedo, tau, g, base, paths, seed):
    """Mean and standard error of the reflected share of a beam."""
    rng = np.random.default_rng(seed)
    beam = np.tile([np.sqrt(1.0 - mu0**2), 0.0, mu0], (paths, 1))
    out, weight, reflected = _facets(rng, beam, ior, alpha)
    total = np.where(reflected, weight, 0.0)
    number = np.flatnonzero(~reflected & (weight > 0.0))
    # z upwards, depth downwards.
    way, weight, depth = out[number], weight[number], np.zeros(len(number))
    while len(number):
        depth = depth + rng.exponential(size=len(number)) * -way[:, 2]
        up, down = depth < 0.0, depth > tau
        kept = np.where(down, rng.random(len(number)) < base, rng.random(len(number)) < albedo) | up
        number, way, weight, depth, up, down = (a[kept] for a in (number, way, weight, depth, up, down))
        within = ~up & ~down
        way[within] = _turned(rng, way[within], g)
        if down.any():
            u, phi = rng.random(down.sum()), 2.0 * np.pi * rng.random(down.sum())
            way[down] = np.stack([np.sqrt(u) * np.cos(phi), np.sqrt(u) * np.sin(phi), np.sqrt(1.0 - u)], axis=1)
            depth[down] = tau
        if up.any():
            # Seen from below: its z turned about.
            flip = np.array([1.0, 1.0, -1.0])
            out, factor, reflected = _facets(rng, -way[up] * flip, 1.0 / ior, alpha)
            weight[up] *= factor
            way[up] = out * flip
            depth[up] = 0.0
            gone = np.zeros(len(number), dtype=bool)
            gone[up] = ~reflected
            total[number[gone]] += weight[gone]
            kept = ~gone & (weight > 0.0)
            number, way, weight, depth = (a[kept] for a in (number, way, weight, depth))
    return total.mean(), total.std() / np.sqrt(paths)
