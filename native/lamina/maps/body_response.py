# SPDX-License-Identifier: GPL-3.0-or-later
"""Targets for Cycles' node in a body of finite size.

The inversion of subsurface_inputs assumes a flat and infinitely thick body. In a thin part, more light leaves, and it
leaves farther away. Therefore uniform media are walked in the same mesh: three with different albedos, and a fourth
like the second with a longer path. At points of the surface, the exit albedo of each gives its apparent coordinate u of
node_response. The relation from u and the logarithm of the path to the apparent u and the logarithm of the exit
distance is interpolated linearly between these media, and inverted. For a uniform interior with a matched boundary the
result is the interior itself."""

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
from ..subsurface.response_table import CURVE, Curves, distance_per_path, response_curves
from .nearest import BLOCK, nearest

ROUNDS = 6  # the media are chosen again from the last corrected targets
ROUGH_POINTS, ROUGH_SAMPLES = 256, 48
POINTS, LEAST_SAMPLES, MOST_SAMPLES = 2048, 96, 384
EFFORT = 0.25  # share of the walks of the map
# At a point of the map, the mean over the nearest points is used: at least NEIGHBOURS, and so many that the mean has
# AVERAGED samples, since the relation of albedo and medium is curved.
NEIGHBOURS, AVERAGED = 8, 3072
SHARES = (0.15, 0.85)  # quantiles of u at which the first and the third medium lie; the second lies in the middle
LEAST_SPREAD = 0.06  # least distance in u between neighbours among these media
LONGER = 0.25  # logarithm of the fourth medium's path over that of the second
# Where a thin body hides the path, the path stays near the estimate: this change of the logarithm of the exit distance
# between the media counts as noise.
HIDDEN = 0.02
MOST_STEP = 3.0  # change of the logarithm of the path, in units of LONGER


class Medium(NamedTuple):
    """A uniform medium: the coordinate u and the mean free path in mm of each channel."""

    u: np.ndarray
    path: np.ndarray


class Seen(NamedTuple):
    """How a medium shows itself: the exit albedo, and the mean exit distance in mm, (points, channels)."""

    albedo: np.ndarray
    distance: np.ndarray


def targets_in_body(albedo: np.ndarray, distance: np.ndarray, walker: Walker, g: float, ior: float, roughness: float,
                    step: Progress) -> tuple[np.ndarray, np.ndarray]:
    """(albedo, distance) that subsurface_inputs needs, for which the node in the walker's mesh has this exit albedo and
    mean exit distance in mm; all (points, channels), means over directions. Deterministic."""
    node = response_curves(g, *mean_entry_cosines(ior, roughness))
    bare = response_curves(g, *mean_entry_cosines(LEAST_IOR, 0.0))
    apparent, count = _u_of(node, albedo), len(albedo)
    # The exit distance without a boundary, if a boundary changes it as in a half-space.
    bare_way, node_way = (np.interp(apparent, CURVE, curves.full_distance) for curves in (bare, node))
    without = distance * bare_way / node_way
    u, path = apparent, distance / distance_per_path(node.full_distance, node, g, apparent)
    few = _some(count, ROUGH_POINTS)
    for number in range(ROUNDS):
        media = _media(u, path, walker.solid_size)
        seen = _all_seen(media, walker.with_points(few, ROUGH_SAMPLES, walker.seed), bare, g,
                         portion(step, 0.2 * number / ROUNDS, 0.2 * (number + 1) / ROUNDS))
        seen = [Seen(*(np.broadcast_to(values.mean(axis=0), albedo.shape) for values in one)) for one in seen]
        u, path = _corrected(apparent, without, media, seen, bare)
    chosen = _some(count, POINTS)
    samples = int(np.clip(EFFORT * count * walker.samples / (len(media) * len(chosen)), LEAST_SAMPLES, MOST_SAMPLES))
    media = _media(u, path, walker.solid_size)
    exact = _all_seen(media, walker.with_points(chosen, samples, walker.seed), bare, g, portion(step, 0.2, 1.0))
    places, averaged = walker.positions[chosen], max(NEIGHBOURS, -(-AVERAGED // samples))
    for first in range(0, count, BLOCK):
        part = slice(first, first + BLOCK)
        near, weights = nearest(places, walker.positions[part], averaged)
        seen = [Seen(*(np.einsum("pk,pkc->pc", weights, values[near]) for values in one)) for one in exact]
        u[part], path[part] = _corrected(apparent[part], without[part], media, seen, bare)
    return np.interp(u, CURVE, node.full_albedo), path * distance_per_path(node.full_distance, node, g, u)


def _some(count: int, most: int) -> np.ndarray:
    """Indices of at most `most` points, evenly spread."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).astype(int))


def _u_of(curves: Curves, albedo: np.ndarray) -> np.ndarray:
    """The coordinate u of the half-space with this exit albedo, which decreases along CURVE."""
    return np.interp(-albedo, -curves.full_albedo, CURVE)


def _media(u: np.ndarray, paths: np.ndarray, size: float) -> list[Medium]:
    """Three media in the range of u, with the paths of points that have about this u, and a fourth: the second with a
    longer path."""
    low, high = np.quantile(u, SHARES, axis=0)
    middle, half = 0.5 * (low + high), np.maximum(0.5 * (high - low), LEAST_SPREAD)
    shortest, longest = max(1e-6 * size, 2.0 / MOST_COEFFICIENT), 1e3 * size
    found = []
    for sign in (-1.0, 0.0, 1.0):
        at = np.clip(middle + sign * half, CURVE[0], CURVE[-1])
        path = [np.mean(paths[np.argsort(np.abs(u[:, c] - at[c]), kind="stable")[:max(16, len(u) // 8)], c])
                for c in range(CHANNELS)]
        found.append(Medium(at, np.clip(path, shortest, longest)))
    return [*found, Medium(found[1].u, found[1].path * np.exp(LONGER))]


def _all_seen(media: list[Medium], walker: Walker, curves: Curves, g: float, step: Progress) -> list[Seen]:
    """Walks in each medium, from the points of a walker."""
    ends = np.linspace(0.0, 1.0, len(media) + 1)
    return [_seen(medium, walker, curves, g, portion(step, low, high))
            for medium, low, high in zip(media, ends, ends[1:], strict=False)]


def _seen(medium: Medium, walker: Walker, curves: Curves, g: float, step: Progress) -> Seen:
    """Walks in the medium, from the points of a walker."""
    single = np.interp(medium.u, CURVE, curves.single)
    material = EndMaterial(tuple(single / medium.path), tuple((1.0 - single) / medium.path), g)
    bare = walker.with_matched(Interior.uniform(material))
    dark = Lit()
    part = part_of(job_of("exits", bare, dark), (1, 1), bare, dark,
                   lambda fraction, _: step(fraction, "Shape of the body"))
    found = merge_walks([part])
    expected = medium.path * distance_per_path(curves.full_distance, curves, g, medium.u)  # if no light leaves
    distance = found.mean_distance.value  # type: ignore[union-attr]  # of this kind
    return Seen(found.albedo.value, np.where(np.isfinite(distance), distance, expected))  # type: ignore[union-attr]


def _corrected(apparent: np.ndarray, distance: np.ndarray, media: list[Medium], seen: list[Seen],
               curves: Curves) -> tuple[np.ndarray, np.ndarray]:
    """(u, mean free path in mm) of the node's medium, from the apparent u and the mean exit distance."""
    # The apparent u is that of the mean albedo: the mean of noisy u would be biased.
    shown = [_u_of(curves, one.albedo) for one in seen]
    ways = [np.log(np.maximum(one.distance, 1e-12)) for one in seen]
    tilt, by_path = shown[3] - shown[1], ways[3] - ways[1]
    upper = apparent > shown[1]  # between the second medium and the third

    def ends(low, middle, high):
        return np.where(upper, middle, low), np.where(upper, high, middle)

    first, second = ends(*shown[:3])
    valid = second - first > 1e-3
    spread = np.where(valid, second - first, 1.0)
    # Along the line from the first medium to the second, and in the direction of longer paths.
    along = np.where(valid, (apparent - first) / spread, 0.5)
    tilt = np.where(valid, tilt / spread, 0.0)
    first, second = ends(*ways[:3])
    slope = second - first
    rest = np.log(np.maximum(distance, 1e-12)) - first - along * slope
    by_path = by_path - tilt * slope
    longer = np.clip(rest * by_path / (by_path**2 + HIDDEN**2), -MOST_STEP, MOST_STEP)
    along = along - longer * tilt

    def between(low, middle, high):
        first, second = ends(low, middle, high)
        return first + along * (second - first)

    u = between(*(one.u for one in media[:3]))
    path = np.exp(between(*(np.log(one.path) for one in media[:3])) + longer * LONGER)
    return np.clip(u, CURVE[0], CURVE[-1]), path
