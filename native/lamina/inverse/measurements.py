# SPDX-License-Identifier: GPL-3.0-or-later
"""What was measured: values, where, and how surely."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..common.arguments import broadcast, check_choice, cosines, finite_array
from ..common.errors import ArgumentError, quoted
from ..solver.core_calls import path_of, side_of
from .light import BeamLight, DirectionLight
from .template import check_changes

DIFFUSE = "diffuse"
PARTS = ("total", "scattered", "direct")
# A value may be this many sigma outside its range, by noise.
LARGEST_Z = 5.0
LEAST_SIGMA, MOST_SIGMA = 1e-100, 1e100  # squares of differences in units of sigma must be numbers


@dataclass(frozen=True, eq=False, kw_only=True)
class Measurement:
    """What all measurements share.

    values: what was measured, in the shape of the places where it was (directions, cosines, distances), with a last
        axis of channels if the template has several.
    sigma: standard error of the values, absolute.
    relative: standard error of the values relative to them. Both, numbers or arrays that broadcast with `values`, add
        as squares; at least one must be given, and the whole must lie in [1e-100, 1e100]. The relative part is taken of
        the fitted values, so noise does not bias the fit.
    changes: what differs from the template in this measurement, by path, such as {"base": lamina.Lambert(0.05)} or
        {"layers[0].thickness": 2.0}; a value may be free too.
    """

    values: Any
    sigma: Any = 0.0
    relative: Any = 0.0
    changes: Mapping[str, object] | None = None

    most = math.inf  # of a value
    unit = "1/sr"
    needs_lengths = False

    @property
    def places(self) -> tuple[int, ...]:
        """The shape of the places: that of `values` without channels."""
        raise NotImplementedError

    def expected(self, light) -> np.ndarray:
        """The values of one channel of a stack, flat. `light`: a BeamLight for those that need lengths, else a
        DirectionLight."""
        raise NotImplementedError

    @property
    def channels(self) -> int:
        return self.values.shape[-1]

    @property
    def label(self) -> str:
        """The measurement in a few words."""
        count = math.prod(self.values.shape)
        return f"{type(self).__name__}, {count} {'value' if count == 1 else 'values'}"

    def _check(self) -> None:
        """Checks values and errors, and gives them the shape (places, channels). Raises ArgumentError."""
        check_changes(self.changes)
        values = finite_array(self.values, "values")
        places = self.places
        if values.shape == places:
            values = values[..., None]
        if values.shape[:-1] != places or values.ndim != len(places) + 1 or values.size == 0:
            raise ArgumentError(f"values have the shape {np.shape(self.values)}: must have the shape {places} of the "
                                "places, or one more axis, of channels")
        errors = {}
        for name in ("sigma", "relative"):
            given = finite_array(getattr(self, name), name)
            if np.any(given < 0.0):
                raise ArgumentError(f"{name} = {given[given < 0.0].flat[0]:g}: must not be negative")
            if given.shape == places and places:
                given = given[..., None]
            try:
                errors[name] = np.broadcast_to(given, values.shape).reshape(-1, values.shape[-1])
            except ValueError:
                raise ArgumentError(f"{name} has the shape {given.shape}: must be a number, or broadcast with values "
                                    f"{values.shape}") from None
        values = values.reshape(-1, values.shape[-1])
        found = np.hypot(errors["sigma"], errors["relative"] * np.abs(values))
        if not np.all(found > 0.0):
            where = "" if not np.any(found > 0.0) else f" of the value {values[found == 0.0][0]:g}"
            raise ArgumentError(f"sigma{where} = 0: the standard error must be positive; give sigma, relative or both")
        wrong = (found < LEAST_SIGMA) | (found > MOST_SIGMA)
        if np.any(wrong):
            raise ArgumentError(f"sigma of the value {values[wrong][0]:g} = {found[wrong][0]:g}: must lie in "
                                f"[{LEAST_SIGMA:g}, {MOST_SIGMA:g}]")
        low = values < -LARGEST_Z * found
        if np.any(low):
            raise ArgumentError(f"values hold {values[low][0]:g} with sigma {found[low][0]:.3g}: must not be negative, "
                                "except by noise")
        high = values > self.most + LARGEST_Z * found
        if np.any(high):
            raise ArgumentError(f"values hold {values[high][0]:g}: must be at most {self.most:g}; shares are not given "
                                "in percent")
        for name, value in {"values": values, **errors}.items():
            object.__setattr__(self, name, value)


def _angles(of: Measurement, names: tuple[str, ...]) -> None:
    """Checks the cosines and azimuths of a measurement and gives them one shape. Raises ArgumentError."""
    arrays = [finite_array(getattr(of, name), name) for name in names]
    for index, name in enumerate(names):
        if name == "dphi":
            outside = np.abs(arrays[index]) > 2.0 * math.pi + 1e-6
            if np.any(outside):
                raise ArgumentError(f"dphi = {arrays[index][outside].flat[0]:g}: must lie in [-2 pi, 2 pi] radians; "
                                    "are these degrees?")
        elif np.any(arrays[index] > 1.0):
            wrong = arrays[index][arrays[index] > 1.0].flat[0]
            raise ArgumentError(f"{name} = {wrong:g}: must be a cosine in (0, 1], not an angle")
        else:
            arrays[index] = cosines(arrays[index], name)
    for name, array in zip(names, broadcast(arrays, names), strict=True):
        object.__setattr__(of, name, array)


@dataclass(frozen=True, eq=False)
class Brdf(Measurement):
    """Values of the BRDF in 1/sr, without specular reflection.

    mu_o, mu_i: cosines of the outgoing and incoming directions with the normal, (0, 1].
    dphi: azimuth in radians, 0 where light keeps its azimuth (forward), pi back towards the light. Arrays broadcast.
    side: on which light enters, "top" or "bottom".

    The members of Measurement follow, by name: values, sigma, relative, changes. Raises ArgumentError."""

    mu_o: Any
    mu_i: Any
    dphi: Any
    side: str = "top"

    path = "reflect"

    def __post_init__(self):
        side_of(self.side)
        _angles(self, ("mu_o", "mu_i", "dphi"))
        self._check()

    @property
    def places(self):
        return self.mu_o.shape

    def expected(self, light: DirectionLight):
        return light.points(side_of(self.side), path_of(self.path), self.mu_o, self.mu_i, self.dphi)


@dataclass(frozen=True, eq=False)
class Btdf(Brdf):
    """Values of the BTDF in 1/sr, without unscattered light; see Brdf."""

    path = "transmit"


@dataclass(frozen=True, eq=False)
class Reflectance(Measurement):
    """Hemispherical reflectance, [0, 1], for beams or for uniform diffuse light.

    mu_i: cosines of the beams with the normal, (0, 1], or "diffuse".
    part: "total", "scattered" (without specular reflection) or "direct" (specular reflection alone).
    side: on which light enters, "top" or "bottom".

    The members of Measurement follow, by name: values, sigma, relative, changes. Raises ArgumentError."""

    mu_i: Any
    part: str = "total"
    side: str = "top"

    path = "reflect"
    most = 1.0
    unit = "1"

    def __post_init__(self):
        side_of(self.side)
        check_choice(self.part, "part", PARTS)
        if isinstance(self.mu_i, str):
            if self.mu_i != DIFFUSE:
                raise ArgumentError(f"mu_i = {quoted(self.mu_i)}: must be a cosine in (0, 1] or 'diffuse'")
        else:
            _angles(self, ("mu_i",))
        self._check()

    @property
    def places(self):
        return () if isinstance(self.mu_i, str) else self.mu_i.shape

    def expected(self, light: DirectionLight):
        scattered, direct = light.fluxes(side_of(self.side), path_of(self.path), self.mu_i)
        return {"total": scattered + direct, "scattered": scattered, "direct": direct}[self.part]


@dataclass(frozen=True, eq=False)
class Transmittance(Reflectance):
    """Hemispherical transmittance, [0, 1]; "direct" is unscattered light alone. See Reflectance."""

    path = "transmit"


@dataclass(frozen=True, eq=False)
class Profile(Measurement):
    """Flux density of the light of a pencil beam that leaves at a distance from it, 1/mm^2, without specular reflection
    and unscattered light. All media of the template need lengths, see lamina.searchlight.

    r: distances in mm, larger than 0.
    mu_i: cosine of the beam with the normal, (0, 1].
    path: "reflect" or "transmit".

    The members of Measurement follow, by name: values, sigma, relative, changes. Raises ArgumentError."""

    r: Any
    mu_i: float = 1.0
    path: str = "reflect"

    unit = "1/mm^2"
    needs_lengths = True

    def __post_init__(self):
        path_of(self.path)
        radii = finite_array(self.r, "r")
        if np.any(radii <= 0.0):
            raise ArgumentError(f"r = {radii[radii <= 0.0].flat[0]:g}: must be larger than 0")
        object.__setattr__(self, "r", radii)
        _angles(self, ("mu_i",))
        if self.mu_i.shape != ():
            raise ArgumentError(f"mu_i has the shape {self.mu_i.shape}: must be one number")
        self._check()

    @property
    def places(self):
        return self.r.shape

    def expected(self, light: BeamLight):
        return light.profile(path_of(self.path), float(self.mu_i), self.r)
