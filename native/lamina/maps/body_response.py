# SPDX-License-Identifier: GPL-3.0-or-later
"""Targets for Cycles' node in a body of finite size.

The inversion of subsurface_inputs assumes a flat and infinitely thick body. In a thin part, more light leaves, and it
leaves farther away. Therefore two uniform media are walked in the same mesh. At points of the surface, the inversion of
their exit albedo and exit distance gives an apparent medium for each. Between the two media, the relation of the true
to the apparent medium is linear in the coordinate u of node_response. For a uniform interior with a matched boundary
the result is the interior itself."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..common.progress import Progress, portion
from ..interior.end_material import CHANNELS, EndMaterial
from ..interior.grid import Interior
from ..interior.parts import job_of, merge_walks, part_of
from ..interior.walk import Lit, Walker
from ..kinds.interiors import MOST_COEFFICIENT
from ..subsurface.entry_cosines import mean_entry_cosines
from ..subsurface.node_parameters import LEAST_IOR
from ..subsurface.response_table import CURVE, Curves, response_curves
from .nearest import BLOCK, nearest

ROUNDS = 6  # the media are chosen again from the last corrected targets
ROUGH_POINTS, ROUGH_SAMPLES = 256, 48
POINTS, LEAST_SAMPLES, MOST_SAMPLES = 2048, 96, 384
EFFORT = 0.25  # share of the walks of the map
# At a point of the map, the mean over the nearest points is used: at least NEIGHBOURS, and so many that the mean has
# AVERAGED samples, since the relation of albedo and medium is curved.
NEIGHBOURS, AVERAGED = 8, 3072
SHARES = (0.15, 0.85)  # quantiles of u at which the media lie
LEAST_SPREAD = 0.06  # half the distance of the media in u


class Medium(NamedTuple):
    """A uniform medium: the coordinate u and the mean free path in mm of each channel."""

    u: np.ndarray
    path: np.ndarray


class Seen(NamedTuple):
    """How a medium shows itself: the exit albedo, and the mean exit distance relative to that of a half-space, (points,
    channels)."""

    albedo: np.ndarray
    farther: np.ndarray


def targets_in_body(albedo: np.ndarray, distance: np.ndarray, walker: Walker, g: float, ior: float, roughness: float,
                    step: Progress) -> tuple[np.ndarray, np.ndarray]:
    """(albedo, distance) that subsurface_inputs needs, for which the node in the walker's mesh has this exit albedo and
    mean exit distance in mm; all (points, channels), means over directions. Deterministic."""
    node = response_curves(g, *mean_entry_cosines(ior, roughness))
    bare = response_curves(g, *mean_entry_cosines(LEAST_IOR, 0.0))
    apparent, count = _u_of(node, albedo), len(albedo)
    u, way = apparent, distance
    few = _some(count, ROUGH_POINTS)
    for number in range(ROUNDS):
        within = portion(step, 0.2 * number / ROUNDS, 0.2 * (number + 1) / ROUNDS)
        media = _media(u, way, node, g, walker.solid_size)
        seen = [_seen(medium, walker.with_points(few, ROUGH_SAMPLES, walker.seed), bare, g, within)
                for medium in media]
        seen = [Seen(*(np.broadcast_to(values.mean(axis=0), albedo.shape) for values in one)) for one in seen]
        u, way = _corrected(apparent, distance, media, seen, bare)
    chosen = _some(count, POINTS)
    samples = int(np.clip(EFFORT * count * walker.samples / (2 * len(chosen)), LEAST_SAMPLES, MOST_SAMPLES))
    media = _media(u, way, node, g, walker.solid_size)
    exact = [_seen(medium, walker.with_points(chosen, samples, walker.seed), bare, g,
                   portion(step, 0.2 + 0.4 * number, 0.6 + 0.4 * number)) for number, medium in enumerate(media)]
    places, averaged = walker.positions[chosen], max(NEIGHBOURS, -(-AVERAGED // samples))
    for first in range(0, count, BLOCK):
        part = slice(first, first + BLOCK)
        near, weights = nearest(places, walker.positions[part], averaged)
        seen = [Seen(*(np.einsum("pk,pkc->pc", weights, values[near]) for values in one)) for one in exact]
        u[part], way[part] = _corrected(apparent[part], distance[part], media, seen, bare)
    return np.interp(u, CURVE, node.full_albedo), way


def _some(count: int, most: int) -> np.ndarray:
    """Indices of at most `most` points, evenly spread."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).astype(int))


def _u_of(curves: Curves, albedo: np.ndarray) -> np.ndarray:
    """The coordinate u of the half-space with this exit albedo, which decreases along CURVE."""
    return np.interp(-albedo, -curves.full_albedo, CURVE)


def _media(u: np.ndarray, way: np.ndarray, curves: Curves, g: float, size: float) -> list[Medium]:
    """Two media near the ends of the range of u, with the paths of points that have about this u."""
    single = np.interp(u, CURVE, curves.single)
    paths = way / np.interp(u, CURVE, curves.full_distance) * (1.0 - g * single)
    low, high = np.quantile(u, SHARES, axis=0)
    middle, half = 0.5 * (low + high), np.maximum(0.5 * (high - low), LEAST_SPREAD)
    found = []
    for sign in (-1.0, 1.0):
        at = np.clip(middle + sign * half, CURVE[0], CURVE[-1])
        path = [np.mean(paths[np.argsort(np.abs(u[:, c] - at[c]), kind="stable")[:max(16, len(u) // 8)], c])
                for c in range(CHANNELS)]
        found.append(Medium(at, np.clip(path, max(1e-6 * size, 2.0 / MOST_COEFFICIENT), 1e3 * size)))
    return found


def _seen(medium: Medium, walker: Walker, curves: Curves, g: float, step: Progress) -> Seen:
    """Walks in the medium, from the points of a walker."""
    single = np.interp(medium.u, CURVE, curves.single)
    material = EndMaterial(tuple(single / medium.path), tuple((1.0 - single) / medium.path), g)
    bare = walker.with_matched(Interior.uniform(material))
    dark = Lit()
    part = part_of(job_of("exits", bare, dark), (1, 1), bare, dark,
                   lambda fraction, _: step(fraction, "Shape of the body"))
    found = merge_walks([part])
    flat = medium.path / (1.0 - g * single) * np.interp(medium.u, CURVE, curves.full_distance)
    farther = np.nan_to_num(found.mean_distance.value, nan=1.0) / flat  # type: ignore[union-attr]  # of this kind
    return Seen(found.albedo.value, farther)  # type: ignore[union-attr]


def _corrected(apparent: np.ndarray, distance: np.ndarray, media: list[Medium], seen: list[Seen],
               curves: Curves) -> tuple[np.ndarray, np.ndarray]:
    """(u, mean exit distance in a half-space) of the node's medium, from apparent values."""
    first, second = seen
    # The apparent u is that of the mean albedo: the mean of noisy u would be biased.
    low, high = (_u_of(curves, one.albedo) for one in seen)
    spread = high - low
    share = np.where(spread > 1e-3, (apparent - low) / np.where(spread > 1e-3, spread, 1.0), 0.5)
    u = media[0].u + share * (media[1].u - media[0].u)
    farther = first.farther + np.clip(share, 0.0, 1.0) * (second.farther - first.farther)
    return np.clip(u, CURVE[0], CURVE[-1]), distance / np.maximum(farther, 1e-3)
