# SPDX-License-Identifier: GPL-3.0-or-later
"""A plain photon walk in three dimensions: a pencil beam on slabs with smooth boundaries, over nothing or a Lambert
surface. It shares nothing with the package."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Slab:
    """Layers of (sigma_s, sigma_a, thickness, g), top first, all of one index, over a Lambert surface or nothing."""

    layers: tuple
    ior: float = 1.0
    base: float | None = None


def fresnel(ior: float, inside):
    """Reflectance for light inside at a cosine; 1 beyond the critical angle."""
    sine2 = ior**2 * (1.0 - inside**2)
    outside = np.sqrt(np.maximum(0.0, 1.0 - sine2))
    s = (ior * inside - outside) / (ior * inside + outside)
    p = (inside - ior * outside) / (inside + ior * outside)
    return np.where(sine2 >= 1.0, 1.0, 0.5 * (s * s + p * p))


def turned(way, cosine, rng):
    phi = 2.0 * np.pi * rng.random(len(cosine))
    sine = np.sqrt(np.maximum(0.0, 1.0 - cosine**2))
    across = np.where(np.abs(way[:, 2:]) < 0.9, [[0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0]])
    first = np.cross(way, across)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(way, first)
    return (cosine[:, None] * way + sine[:, None] * (np.cos(phi)[:, None] * first + np.sin(phi)[:, None] * second))


def henyey_greenstein(g, rng, count):
    u = 2.0 * rng.random(count) - 1.0
    safe = np.where(np.abs(g) < 1e-3, 1.0, g)
    return np.where(np.abs(g) < 1e-3, u, (1.0 + safe**2 - ((1.0 - safe**2) / (1.0 + safe * u)) ** 2) / (2.0 * safe))


def walk(slab: Slab, count: int, seed: int):
    """(x and y of reflected light, of transmitted light), each of shape (n, 2); light reflected specularly at the top
    is left out, its share is fresnel(ior, 1)."""
    rng = np.random.default_rng(seed)
    scatter, absorb, thick, g = (np.array(values, float) for values in zip(*slab.layers, strict=True))
    tops = np.concatenate([[0.0], np.cumsum(thick)])
    total = scatter + absorb
    place = np.zeros((count, 3))
    way = np.tile([0.0, 0.0, 1.0], (count, 1))     # z down
    layer = np.zeros(count, int)
    reflected, transmitted = [], []
    entered = rng.random(count) >= (fresnel(slab.ior, 1.0) if slab.ior != 1.0 else 0.0)
    place, way, layer = place[entered], way[entered], layer[entered]
    while len(place):
        free = -np.log(rng.random(len(place))) / total[layer]
        face = np.where(way[:, 2] > 0.0, tops[layer + 1], tops[layer])
        to_face = (face - place[:, 2]) / np.where(way[:, 2] == 0.0, 1e-30, way[:, 2])
        collides = free < to_face
        place = place + np.where(collides, free, to_face)[:, None] * way
        place[~collides, 2] = face[~collides]
        alive = np.ones(len(place), bool)
        hit = np.flatnonzero(collides)
        survives = rng.random(len(hit)) * total[layer[hit]] < scatter[layer[hit]]
        alive[hit[~survives]] = False
        hit = hit[survives]
        way[hit] = turned(way[hit], henyey_greenstein(g[layer[hit]], rng, len(hit)), rng)
        crossing = np.flatnonzero(~collides)
        layer[crossing] += np.where(way[crossing, 2] > 0.0, 1, -1)
        for end, found in ((-1, reflected), (len(thick), transmitted)):
            out = crossing[layer[crossing] == end]
            if end > 0 and slab.base is not None:
                back = rng.random(len(out)) < slab.base
                alive[out[~back]] = False
                out = out[back]
                up = np.sqrt(rng.random(len(out)))
                phi = 2.0 * np.pi * rng.random(len(out))
                side = np.sqrt(1.0 - up**2)
                way[out] = np.stack([side * np.cos(phi), side * np.sin(phi), -up], axis=1)
                layer[out] = end - 1
                continue
            kept = np.zeros(len(out), bool)
            if slab.ior != 1.0:
                kept = rng.random(len(out)) < fresnel(slab.ior, np.abs(way[out, 2]))
            way[out[kept], 2] *= -1.0
            layer[out[kept]] = 0 if end < 0 else end - 1
            found.append(place[out[~kept], :2])
            alive[out[~kept]] = False
        place, way, layer = place[alive], way[alive], layer[alive]
    return np.concatenate(reflected), np.concatenate(transmitted or [np.zeros((0, 2))])


def at_frequency(points: np.ndarray, q: float, count: int) -> tuple[float, float]:
    """(value, standard error) of the flux times J0(q r): by symmetry the mean of cos(q x) and cos(q y)."""
    waves = 0.5 * (np.cos(q * points[:, 0]) + np.cos(q * points[:, 1]))
    mean = waves.sum() / count
    return mean, np.sqrt(max((waves**2).sum() / count - mean**2, 1e-12) / count)
