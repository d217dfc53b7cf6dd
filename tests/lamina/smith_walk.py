# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that rough GGX facets between two dielectrics scatter any number of times: the random walk on Smith's surface
of Heitz et al. (SIGGRAPH 2016), independent of the core. Heights are uniform in [-1, 1]."""

import numpy as np


def _lambda(z, alpha):
    """Smith's Lambda of directions with these cosines, which may be negative."""
    z = np.clip(z, -0.99999, 0.99999)
    a = z / (alpha * np.sqrt(1.0 - z * z))
    a = np.where(np.abs(a) < 1e-9, 1e-9, a)
    return 0.5 * (-1.0 + np.sign(a) * np.sqrt(1.0 + 1.0 / a**2))


def _heights(rng, ray, height, alpha):
    """Heights of the next facets; infinite where the ray leaves upwards."""
    smith = _lambda(ray[:, 2], alpha)
    above = np.clip(0.5 * (height + 1.0), 1e-12, 1.0)
    free = np.where(ray[:, 2] > 0.0, above ** np.maximum(smith, 0.0), 0.0)
    u = rng.random(len(ray))
    with np.errstate(all="ignore"):
        met = 2.0 * np.clip(above / (1.0 - u) ** (1.0 / smith), 1e-12, 1.0) - 1.0
    return np.where(u > 1.0 - free, np.inf, met)


def _visible_normals(rng, view, alpha):
    """Facets that are visible along `view` (Dupuy and Benyoub 2023)."""
    scale = np.array([alpha, alpha, 1.0])
    stretched = view * scale
    stretched /= np.linalg.norm(stretched, axis=1, keepdims=True)
    phi, u = 2.0 * np.pi * rng.random(len(view)), rng.random(len(view))
    z = (1.0 - u) * (1.0 + stretched[:, 2]) - stretched[:, 2]
    sine = np.sqrt(np.maximum(0.0, 1.0 - z * z))
    half = (np.stack([sine * np.cos(phi), sine * np.sin(phi), z], axis=1) + stretched) * scale
    return half / np.linalg.norm(half, axis=1, keepdims=True)


def reflectance(mu, *, ior, alpha, paths, seed):
    """Mean and standard error of the light that a boundary to a medium of index `ior` reflects, from air."""
    rng = np.random.default_rng(seed)
    ray = np.tile([np.sqrt(1.0 - mu * mu), 0.0, -mu], (paths, 1))
    height, outside = np.ones(paths), np.ones(paths, dtype=bool)
    reflected = 0
    while len(ray):
        up = np.where(outside, 1.0, -1.0)[:, None] * [0.0, 0.0, 1.0] + [1.0, 1.0, 0.0]  # seen from the ray's side
        side = up[:, 2]
        ray = ray * up
        height = side * _heights(rng, ray, side * height, alpha)
        left = np.isinf(height)
        reflected += np.count_nonzero(left & outside)
        ray, height, outside, up = (array[~left] for array in (ray, height, outside, up))
        normal = _visible_normals(rng, -ray, alpha)
        cosine = np.clip(-np.einsum("ij,ij->i", ray, normal), 1e-6, 1.0)
        ratio = np.where(outside, ior, 1.0 / ior)
        refracted = np.sqrt(np.maximum(0.0, 1.0 - (1.0 - cosine**2) / ratio**2))
        s = (cosine - ratio * refracted) / (cosine + ratio * refracted)
        p = (ratio * cosine - refracted) / (ratio * cosine + refracted)
        turned = rng.random(len(ray)) < np.where(refracted > 0.0, 0.5 * (s * s + p * p), 1.0)
        mirrored = ray + 2.0 * cosine[:, None] * normal
        through = (cosine / ratio - refracted)[:, None] * normal + ray / ratio[:, None]
        ray = np.where(turned[:, None], mirrored, through)
        ray = ray / np.linalg.norm(ray, axis=1, keepdims=True) * up
        outside = outside == turned
    share = reflected / paths
    return share, np.sqrt(share * (1.0 - share) / paths)
