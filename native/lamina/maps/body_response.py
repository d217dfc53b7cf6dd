# SPDX-License-Identifier: GPL-3.0-or-later
"""Media for Cycles' node in a body of finite size.

The inversion of subsurface_inputs assumes a flat and infinitely thick body. In a thin part, more light leaves, and it
leaves farther away. Therefore uniform media are walked in the same mesh: three with different albedos, and a fourth
like the second with a longer path. At points of the surface, the exit albedo of each gives its apparent coordinate u of
node_response. The relation from u and the logarithm of the path to the apparent u and the logarithm of the exit
distance is interpolated linearly between these media, and inverted. For a uniform interior with a matched boundary the
result is the interior itself.

Cycles discards light after 256 flights. The loss depends on the body: in a small one, the light leaves before.
Therefore the walks also tally the light that leaves later than that. Its ratio to the loss in a half-space of the same
medium is interpolated between the media. The lost light is the target of a second closure, found in the same way."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..common.progress import Progress, portion
from ..interior.end_material import CHANNELS, EndMaterial
from ..interior.estimates import exit_estimate
from ..interior.grid import Interior
from ..interior.problem import Samples
from ..interior.walk import Walker
from ..kinds.interiors import MOST_COEFFICIENT
from ..subsurface.entry_cosines import mean_entry_cosines
from ..subsurface.first_flights import FORWARD_COLLISIONS
from ..subsurface.later_flights import LATER_FLIGHTS
from ..subsurface.node_inputs import NEGLIGIBLE_LOSS, Closure
from ..subsurface.node_parameters import LEAST_ALBEDO, LEAST_IOR
from ..subsurface.response_table import CURVE, Curves, distance_per_path, place_of, response_curves
from .map_walk import MapWalk
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
# Exit albedo of the second closure where the limit of flights loses most light. A brighter one would lose light itself.
BRIGHTEST = 0.8
FIRST = 0.8  # share of the progress: the first closure
FAINT = 1e-3  # a lost share of this size counts as noise where its change with the path is measured
LEAST_LIGHT = 1e-12  # against division by 0


class Medium(NamedTuple):
    """A uniform medium: the coordinate u and the mean free path in mm of each channel."""

    u: np.ndarray
    path: np.ndarray


class Seen(NamedTuple):
    """How a medium shows itself, (points, channels): the exit albedo, and the mean exit distance in mm. `late`: the
    part of the exit albedo that Cycles loses; `late_moment`: this part times its mean exit distance."""

    albedo: np.ndarray
    distance: np.ndarray
    late: np.ndarray
    late_moment: np.ndarray


class Lost(NamedTuple):
    """The share of the light that the limit of flights loses, and this share times its mean exit distance in mm."""

    share: np.ndarray
    moment: np.ndarray


class Along(NamedTuple):
    """The position of points between the media. `upper`: between the second and the third, otherwise the first and the
    second. `share`: of the way between these. `longer`: step towards longer paths, in units of LONGER.
    `shown`: the apparent u of the node's medium, which is not that of the target where the target is too dark."""

    upper: np.ndarray
    share: np.ndarray
    longer: np.ndarray
    shown: np.ndarray

    def between(self, values: list[np.ndarray]) -> np.ndarray:
        """Values of the first three media, interpolated and extrapolated."""
        first, second = _ends(self.upper, values)
        return first + self.share * (second - first)


def closures_in_body(albedo: np.ndarray, distance: np.ndarray, walked: MapWalk, g: float, ior: float,
                     roughness: float) -> tuple[Closure, Closure | None]:
    """Closures with which the node in the mesh has this exit albedo and mean exit distance in mm, both (points,
    channels), means over directions. The second replaces the light that the limit of flights loses in the mesh; None
    if the first can make up for it. Deterministic."""
    walker, seed, step = walked.walker, walked.samples.seed, walked.step
    share_of_walks = EFFORT * len(albedo) * walked.samples.count / (4 * min(len(albedo), POINTS))
    samples = Samples(int(np.clip(share_of_walks, LEAST_SAMPLES, MOST_SAMPLES)), seed)
    node = response_curves(g, *mean_entry_cosines(ior, roughness))
    body = _Body(albedo, distance, walker, g, node, samples, portion(step, 0.0, FIRST))
    first, lost = body.closure(albedo, distance)
    if not np.any(lost.share > NEGLIGIBLE_LOSS):
        # Raise the targets, so that what the limit leaves has the wanted albedo and distance.
        kept, moment = 1.0 - lost.share, distance - lost.moment
        brighter, farther = np.minimum(albedo / kept, 1.0), distance**2 * kept / np.maximum(moment, 0.5 * distance)
        return body.closure(brighter, farther)[0], None
    light = albedo * lost.share
    weight = float(light.max()) / BRIGHTEST
    way = np.where(lost.share > LEAST_LIGHT, lost.moment / np.maximum(lost.share, LEAST_LIGHT), distance)
    way = np.minimum(way, walker.solid_size)
    body = _Body(light / weight, way, walker, g, node, Samples(LEAST_SAMPLES, seed), portion(step, FIRST, 1.0))
    return first, body.closure(light / weight, way)[0]._replace(weight=weight)


class _Body:
    """Walks in four media that suit the given exit albedo and mean exit distance."""

    def __init__(self, albedo: np.ndarray, distance: np.ndarray, walker: Walker, g: float, node: Curves,
                 samples: Samples, step: Progress):
        self._walker, self._g, self._node = walker, g, node
        self._bare = response_curves(g, *mean_entry_cosines(LEAST_IOR, 0.0))
        self._darkest = float(np.interp(-LEAST_ALBEDO, -node.single, CURVE))  # the largest u
        apparent, without = self._apparent(albedo, distance)
        u = np.minimum(apparent, self._darkest)
        path = distance / distance_per_path(node.full_distance, node, g, u)
        few, rough = _some(len(albedo), ROUGH_POINTS), Samples(ROUGH_SAMPLES, samples.seed)
        for number in range(ROUNDS):
            self._media = _media(u, path, walker.solid_size, self._darkest)
            seen = self._all_seen(few, rough, portion(step, 0.2 * number / ROUNDS, 0.2 * (number + 1) / ROUNDS))
            seen = [Seen(*(np.broadcast_to(values.mean(axis=0), albedo.shape) for values in one)) for one in seen]
            u, path, _ = self._corrected(apparent, without, seen)
        chosen = _some(len(albedo), POINTS)
        self._media = _media(u, path, walker.solid_size, self._darkest)
        self._seen = self._all_seen(chosen, samples, portion(step, 0.2, 1.0))
        self._positions = walker.problem.points.positions
        self._places, self._averaged = self._positions[chosen], max(NEIGHBOURS, -(-AVERAGED // samples.count))

    def closure(self, albedo: np.ndarray, distance: np.ndarray) -> tuple[Closure, Lost]:
        """(closure with this exit albedo and mean exit distance in mm without the limit of flights, what the limit
        loses)."""
        node, g = self._node, self._g
        apparent, without = self._apparent(albedo, distance)
        u, path, shown, share, moment = (np.empty_like(albedo) for _ in range(5))
        for first in range(0, len(albedo), BLOCK):
            part = slice(first, first + BLOCK)
            near, weights = nearest(self._places, self._positions[part], self._averaged)
            seen = [Seen(*(np.einsum("pk,pkc->pc", weights, values[near]) for values in one)) for one in self._seen]
            u[part], path[part], along = self._corrected(apparent[part], without[part], seen)
            shown[part] = along.shown
            known = [_half_space_loss(self._bare, g, *medium) for medium in self._media]
            share[part], moment[part] = _lost(along, seen, known, _half_space_loss(node, g, u[part], path[part]))
        way = path * distance_per_path(node.full_distance, node, g, u)
        # Cycles does not walk in media below LEAST_ALBEDO; it scales the light instead.
        scale = np.minimum(albedo / np.interp(shown, CURVE, node.full_albedo), 1.0)
        light = np.interp(u, CURVE, node.full_albedo) * np.where(u < self._darkest, 1.0, scale)
        return Closure(1.0, light, way), Lost(share, moment)

    def _apparent(self, albedo: np.ndarray, distance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(u of a half-space with this exit albedo, the exit distance without a boundary, if the boundary changes it as
        in a half-space)."""
        apparent = place_of(self._node.full_albedo, albedo)
        bare, node = (np.interp(apparent, CURVE, curves.full_distance) for curves in (self._bare, self._node))
        return apparent, distance * bare / node

    def _corrected(self, apparent: np.ndarray, distance: np.ndarray,
                   seen: list[Seen]) -> tuple[np.ndarray, np.ndarray, Along]:
        """(u, mean free path in mm, position between the media) of the node's medium, from the apparent u and the mean
        exit distance."""
        # The apparent u is that of the mean albedo: the mean of noisy u would be biased.
        shown = [place_of(self._bare.full_albedo, one.albedo) for one in seen]
        ways = [np.log(np.maximum(one.distance, 1e-12)) for one in seen]
        places = [one.u for one in self._media]
        tilt, by_path = shown[3] - shown[1], ways[3] - ways[1]
        upper = apparent > shown[1]  # between the second medium and the third
        first, second = _ends(upper, shown)
        valid = second - first > 1e-3
        spread = np.where(valid, second - first, 1.0)
        # Along the line from the first medium to the second, and in the direction of longer paths.
        brighter, darker = _ends(upper, places)
        most = np.where(darker > brighter, (self._darkest - brighter) / np.maximum(darker - brighter, 1e-9), 0.5)
        # Where light crosses the body without scattering, all albedos look alike: a darker target needs scaled light.
        alike = np.where(apparent > second + 1e-3, most, np.minimum(0.5, most))
        along = np.where(valid, np.minimum((apparent - first) / spread, most), alike)
        tilt_along = np.where(valid, tilt / spread, 0.0)
        near, far = _ends(upper, ways)
        slope = far - near
        rest = np.log(np.maximum(distance, 1e-12)) - near - along * slope
        by_path = by_path - tilt_along * slope
        longer = np.clip(rest * by_path / (by_path**2 + HIDDEN**2), -MOST_STEP, MOST_STEP)
        along = np.minimum(along - longer * tilt_along, most)
        found = Along(upper, along, longer, first + along * (second - first) + longer * tilt)
        path = np.exp(found.between([np.log(one.path) for one in self._media]) + longer * LONGER)
        return np.clip(found.between(places), CURVE[0], self._darkest), path, found

    def _all_seen(self, chosen: np.ndarray, samples: Samples, step: Progress) -> list[Seen]:
        """Walks in each medium, from the chosen points."""
        walker, ends = self._walker.only(chosen), np.linspace(0.0, 1.0, 5)
        return [_seen(medium, walker, samples, self._bare, self._g, portion(step, low, high))
                for medium, low, high in zip(self._media, ends[:-1], ends[1:], strict=True)]


def _some(count: int, most: int) -> np.ndarray:
    """Indices of at most `most` points, evenly spread."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).astype(int))


def _media(u: np.ndarray, paths: np.ndarray, size: float, darkest: float) -> list[Medium]:
    """Three media in the range of u, at most `darkest`, with the paths of points that have about this u, and a fourth:
    the second with a longer path."""
    low, high = np.quantile(u, SHARES, axis=0)
    middle, half = 0.5 * (low + high), np.maximum(0.5 * (high - low), LEAST_SPREAD)
    shortest, longest = max(1e-6 * size, 2.0 / MOST_COEFFICIENT), 1e3 * size
    found = []
    for sign in (-1.0, 0.0, 1.0):
        at = np.clip(middle + sign * half, CURVE[0], darkest)
        path = [np.mean(paths[np.argsort(np.abs(u[:, c] - at[c]), kind="stable")[:max(16, len(u) // 8)], c])
                for c in range(CHANNELS)]
        found.append(Medium(at, np.clip(path, shortest, longest)))
    return [*found, Medium(found[1].u, found[1].path * np.exp(LONGER))]


def _seen(medium: Medium, walker: Walker, samples: Samples, curves: Curves, g: float, step: Progress) -> Seen:
    """Walks in the medium, from the points of a walker."""
    single = np.interp(medium.u, CURVE, curves.single)
    material = EndMaterial(tuple(single / medium.path), tuple((1.0 - single) / medium.path), g)
    # Cycles continues with transport coefficients, so that its later flights have the length of several.
    late_after = FORWARD_COLLISIONS + LATER_FLIGHTS / (1.0 - g * single)
    moments, products, counts, late = walker.matched(Interior.uniform(material)).exits(
        samples, lambda fraction, _: step(fraction, "Shape of the body"), late_after=tuple(late_after))
    found = exit_estimate(moments, products, counts, samples.count, 0.0)
    expected = medium.path * distance_per_path(curves.full_distance, curves, g, medium.u)  # if no light leaves
    distance = found.mean_distance.value
    late = late / samples.count
    return Seen(found.albedo.value, np.where(np.isfinite(distance), distance, expected), late[..., 0], late[..., 1])


def _ends(upper: np.ndarray, values: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Values of the two media between which points lie."""
    return np.where(upper, values[1], values[0]), np.where(upper, values[2], values[1])


def _half_space_loss(curves: Curves, g: float, u: np.ndarray, path: np.ndarray) -> Lost:
    """The loss in a half-space."""
    kept, full = (np.interp(u, CURVE, values) for values in (curves.albedo / curves.full_albedo, curves.full_distance))
    moment: np.ndarray = full - kept * np.interp(u, CURVE, curves.distance)
    return Lost(1.0 - kept, moment * path / (1.0 - g * np.interp(u, CURVE, curves.single)))


def _lost(along: Along, seen: list[Seen], known: list[Lost], here: Lost) -> Lost:
    """The loss in the body. `known`: the loss of the media in a half-space; `here`: of the points' media."""
    # Noisy points lie far outside of the media, where neither the line nor the exponential holds.
    inside = along._replace(share=np.clip(along.share, 0.0, 1.0), longer=np.clip(along.longer, -1.0, 1.0))
    light = [np.maximum(one.albedo, LEAST_LIGHT) for one in seen]
    shares, moments = ([part / whole for part, whole in zip(parts, light, strict=True)]
                       for parts in ([one.late for one in seen], [one.late_moment for one in seen]))
    found = []
    for values, reference, target in ((shares, [one.share for one in known], here.share),
                                      (moments, [one.moment for one in known], here.moment)):
        ratio = inside.between(values) / np.maximum(inside.between(reference), LEAST_LIGHT)
        # In units of the second medium's lost share, so that the same FAINT suits both.
        second, fourth = (known[1].share * values[k] / np.maximum(reference[k], LEAST_LIGHT) for k in (1, 3))
        found.append(np.maximum(target * ratio * ((fourth + FAINT) / (second + FAINT)) ** inside.longer, 0.0))
    # A noisy path must not make the loss larger than in a half-space or in one of the media.
    most = np.maximum(here.share, np.max(shares, axis=0)) / np.maximum(found[0], LEAST_LIGHT)
    return Lost(*(np.minimum(most, 1.0) * one for one in found))
