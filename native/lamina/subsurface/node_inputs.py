# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of Cycles' Subsurface Scattering node for a target exit albedo and mean exit distance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..common.arguments import check_number, finite_array
from ..common.by_content import ByContent
from ..common.errors import ArgumentError, clipped
from ..kinds.limits import MOST_NODE_IOR
from .entry_cosines import entry_cosines, mean_entry_cosines
from .node_parameters import LEAST_ALBEDO, LEAST_IOR, colour_of_albedo, radius_of_path
from .node_response import LARGEST_G
from .response_table import CURVE, Curves, distance_per_path, place_of, response_curves

# Relative errors of the tabulated response: exit albedo, mean exit distance. Up to .002 and .0025 for single-scattering
# albedos below .5 with g above .8.
RESPONSE_ERRORS = (5e-4, 1e-3)
# Up to this share of lost light, colour and radius of a single closure compensate for the limit of flights.
NEGLIGIBLE_LOSS = 0.002
FIRST_VERSION, MOST_VERSION = (4, 2), 100  # of Blender


class Walk(NamedTuple):
    """The medium of a random walk: single-scattering albedo and mean free path, arrays of the targets' shape."""

    albedo: np.ndarray
    path: np.ndarray


class Closure(NamedTuple):
    """One node by its medium in a flat and infinitely thick body: exit albedo and mean exit distance, without the limit
    of flights. `weight`: factor of its light."""

    weight: float
    albedo: np.ndarray
    distance: np.ndarray


class Node(NamedTuple):
    """A node by Blender's release, and by the inputs that have one number for all channels."""

    version: tuple[int, int]
    anisotropy: float
    ior: float
    roughness: float


@dataclass(frozen=True, eq=False)
class SubsurfaceInputs(ByContent):
    """Inputs of the Subsurface Scattering node (Random Walk) of Cycles. Arrays have the shape of the targets; lengths
    have the unit of the target distance, with the node's Scale at 1.

    `color`, `radius`, `anisotropy`, `ior` and `roughness` are inputs of the node. Where Cycles' limit of 256 flights
    loses light, `extra_weight` is above 0: an Add Shader must then add a second node with `extra_color`, `extra_radius`
    and otherwise equal inputs, multiplied by this weight. `albedo` and `distance` are the resulting exit albedo and
    mean exit distance; `albedo_error` and `distance_error` are their errors relative to the targets. `version` is the
    release of Blender for which the inputs are valid."""

    version: tuple[int, int]
    color: np.ndarray
    radius: np.ndarray
    anisotropy: float
    ior: float
    roughness: float
    extra_weight: float
    extra_color: np.ndarray
    extra_radius: np.ndarray
    albedo: np.ndarray
    distance: np.ndarray
    albedo_error: np.ndarray
    distance_error: np.ndarray

    @property
    def has_boundary(self) -> bool:
        """True if the material needs a Glossy closure above the nodes, for the boundary on top of the stack."""
        return self.ior > LEAST_IOR

    @property
    def report(self) -> str:
        """The predicted result of the nodes and its error, as one sentence."""
        release = ".".join(map(str, self.version))
        second = "" if self.extra_weight == 0.0 else f", with a second closure times {self.extra_weight:.4f}"
        errors = zip((self.albedo_error, self.distance_error), RESPONSE_ERRORS, strict=True)
        worst = [100.0 * (np.max(np.abs(error), initial=0.0) + floor) for error, floor in errors]
        return (f"Subsurface Scattering of Blender {release}{second}: exit albedo within {worst[0]:.2g} %, mean exit "
                f"distance within {worst[1]:.2g} %.")


def subsurface_inputs(albedo, distance, anisotropy: float = 0.0, version: tuple[int, int] = (4, 5),
                      mu: float | str = 1.0, ior: float = LEAST_IOR, roughness: float = 0.0) -> SubsurfaceInputs:
    """Inputs for which Cycles' node has the exit albedo `albedo` and the mean exit distance `distance`.

    `albedo`, in [0, 1], is the share of the light entering below the boundary that leaves again. `distance`, at least 0
    in any unit, is the mean distance between entry and exit. Both are numbers or arrays of one shape, such as
    (texels, channels). `anisotropy`, in [0, .9], is the node's anisotropy. Light enters along the view direction at the
    cosine `mu`, in (0, 1], through a boundary of index `ior` (1.01 to 3.8; 1.01: none) and width `roughness` (0 to 1).
    With `mu` = "diffuse", albedo and distance are means for light from all directions with the flux of a uniform sky.
    `version` is the release of Blender: before 5.2 its walk converts colours differently.

    Exact for the walk on a large flat surface of a body much thicker than `distance`. A second closure replaces the
    light that Cycles' limit of 256 flights loses, at the mean distance of the lost light. Raises ArgumentError."""
    version = checked_version(version)
    g = check_number(anisotropy, "anisotropy", f"must lie in [0, {LARGEST_G:g}]", lambda x: 0.0 <= x <= LARGEST_G)
    if not (isinstance(mu, str) and mu == "diffuse"):
        mu = check_number(mu, "mu", 'must lie in (0, 1], or be "diffuse"', lambda x: 0.0 < x <= 1.0)
    ior = check_number(ior, "ior", f"must lie in [{LEAST_IOR:g}, {MOST_NODE_IOR:g}]",
                       lambda x: LEAST_IOR <= x <= MOST_NODE_IOR)
    roughness = check_number(roughness, "roughness", "must lie in [0, 1]", lambda x: 0.0 <= x <= 1.0)
    albedo, distance = _checked_targets(albedo, distance)
    entry = mean_entry_cosines(ior, roughness) if isinstance(mu, str) else entry_cosines(mu, ior, roughness)
    curves = response_curves(g, *entry)
    main = _limited_walk(curves, g, albedo, distance)
    extra, weight = Walk(np.zeros_like(albedo), np.zeros_like(albedo)), 0.0
    if np.any(albedo - _exit_light(curves, g, _full_walk(curves, g, albedo, distance))[0] > NEGLIGIBLE_LOSS * albedo):
        main = _full_walk(curves, g, albedo, distance)
        extra, weight = _lost_walk(curves, g, albedo, distance, main)
    light, way = _exit_light(curves, g, main)
    extra_light, extra_way = _exit_light(curves, g, extra)
    light, way = light + weight * extra_light, light * way + weight * extra_light * extra_way
    with np.errstate(divide="ignore", invalid="ignore"):
        way = np.where(light > 0.0, way / light, 0.0)
    return _inputs(Node(version, g, ior, roughness), main, extra, weight, (light, way), (albedo, distance))


def inputs_of_closures(first: Closure, second: Closure | None, anisotropy: float, version: tuple[int, int], ior: float,
                       roughness: float) -> SubsurfaceInputs:
    """Inputs of closures with known media, for light from all directions. `second`: replaces the light that the limit
    of flights loses in the body, if any. The limit is not taken into account otherwise. `albedo`, `distance` and errors
    are those of the first closure in a flat and infinitely thick body without the limit. Arguments as for
    subsurface_inputs, not checked."""
    curves = response_curves(anisotropy, *mean_entry_cosines(ior, roughness))
    main = _full_walk(curves, anisotropy, first.albedo, first.distance)
    extra, weight = Walk(np.zeros_like(first.albedo), np.zeros_like(first.albedo)), 0.0
    if second is not None:
        extra, weight = _full_walk(curves, anisotropy, second.albedo, second.distance), second.weight
    reached = _exit_light(curves._replace(albedo=curves.full_albedo, distance=curves.full_distance), anisotropy, main)
    node = Node(version, anisotropy, ior, roughness)
    return _inputs(node, main, extra, weight, reached, (first.albedo, first.distance))


def _inputs(node: Node, main: Walk, extra: Walk, weight: float, reached: tuple[np.ndarray, np.ndarray],
            targets: tuple[np.ndarray, np.ndarray]) -> SubsurfaceInputs:
    """Inputs of two walks. `reached`, `targets`: exit albedo and mean exit distance."""
    version, g, _, _ = node
    with np.errstate(divide="ignore", invalid="ignore"):
        errors = [np.where(wanted > 0.0, found / wanted - 1.0, 0.0)
                  for found, wanted in zip(reached, targets, strict=True)]
    return SubsurfaceInputs(
        version, colour_of_albedo(main.albedo, g, version), radius_of_path(main.path, g, version), *node[1:], weight,
        colour_of_albedo(extra.albedo, g, version), radius_of_path(extra.path, g, version), *reached, *errors)


def _limited_walk(curves: Curves, g: float, albedo: np.ndarray, distance: np.ndarray) -> Walk:
    """The walk with this exit albedo and distance, with the limit of flights. Cycles raises lower albedos to
    LEAST_ALBEDO and scales the light instead."""
    least = _at_albedo(curves, LEAST_ALBEDO)
    floor = np.interp(least, CURVE, curves.albedo)
    dark = albedo < floor
    place = np.where(dark, least, place_of(curves.albedo, albedo))
    single = np.where(dark, LEAST_ALBEDO * albedo / floor, np.interp(place, CURVE, curves.single))
    return Walk(single, distance / distance_per_path(curves.distance, curves, g, place))


def _full_walk(curves: Curves, g: float, albedo: np.ndarray, distance: np.ndarray) -> Walk:
    """The walk with this exit albedo and distance, without the limit of flights."""
    least = _at_albedo(curves, LEAST_ALBEDO)
    place = np.minimum(place_of(curves.full_albedo, albedo), least)
    bright = albedo >= np.interp(least, CURVE, curves.albedo)
    limited = _limited_walk(curves, g, albedo, distance)
    return Walk(np.where(bright, np.interp(place, CURVE, curves.single), limited.albedo),
                np.where(bright, distance / distance_per_path(curves.full_distance, curves, g, place), limited.path))


def _lost_walk(curves: Curves, g: float, albedo: np.ndarray, distance: np.ndarray,
               main: Walk) -> tuple[Walk, float]:
    """(walk, weight) of a second closure that has the amount and the mean distance of the light lost by the limit."""
    light, way = _exit_light(curves, g, main)
    lost = np.maximum(albedo - light, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        lost_way = np.where(lost > 1e-9, (albedo * distance - light * way) / lost, 0.0)
    weight = float(lost.max() / curves.albedo[0])
    return _limited_walk(curves, g, lost / weight, np.maximum(lost_way, 0.0)), weight


def _exit_light(curves: Curves, g: float, walk: Walk) -> tuple[np.ndarray, np.ndarray]:
    """(exit albedo, mean exit distance) of a walk in Cycles, with the limit of flights."""
    clamped = np.maximum(walk.albedo, LEAST_ALBEDO)
    place = _at_albedo(curves, clamped)
    light = np.interp(place, CURVE, curves.albedo) * walk.albedo / clamped
    return light, np.interp(place, CURVE, curves.distance) * walk.path / (1.0 - g * clamped)


def _at_albedo(curves: Curves, single) -> np.ndarray:
    return np.interp(-np.asarray(single, float), -curves.single, CURVE)


def checked_version(version) -> tuple[int, int]:
    """Major and minor number of a Blender release. Raises ArgumentError."""
    if isinstance(version, tuple | list) and len(version) >= 2:
        first = tuple(version[:2])
        whole = all(isinstance(n, int) and not isinstance(n, bool) and 0 <= n <= MOST_VERSION for n in first)
        if whole and first >= FIRST_VERSION:
            return first
    raise ArgumentError(f"version = {clipped(repr(version))}: must be a release of Blender from (4, 2) on")


def _checked_targets(albedo, distance) -> tuple[np.ndarray, np.ndarray]:
    """Both targets as arrays of one shape. Raises ArgumentError."""
    albedo, distance = finite_array(albedo, "albedo"), finite_array(distance, "distance")
    if albedo.shape != distance.shape:
        raise ArgumentError(f"distance has the shape {distance.shape}: must have that of albedo, {albedo.shape}")
    for name, values, fits, rule in (
            ("albedo", albedo, (albedo >= 0.0) & (albedo <= 1.0), "must lie in [0, 1]"),
            ("distance", distance, distance >= 0.0, "must be at least 0")):
        if not np.all(fits):
            raise ArgumentError(f"{name} = {values[~fits].flat[0]:g}: {rule}")
    return albedo, distance
