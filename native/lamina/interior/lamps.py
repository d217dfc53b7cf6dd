# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps of unit strength, and the surroundings of a solid. Lengths in mm, angles in radians."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from typing import ClassVar

import numpy as np

from ..common.arguments import check_field, check_whole, finite_array
from ..common.errors import ArgumentError, quoted
from ..kinds.fields import Field

# Behind a smooth boundary, the noise of smaller discs is too large; half of 2 degrees in single precision is a little
# below 1 degree.
LEAST_DISC = (1.0 - 1e-6) * math.radians(1.0)
MOST_LINKINGS = 64
_ANGLE = Field("angle", 0.0, 1.0)
_RADIUS = Field("radius", 0.0, 1e12, unit="mm")
_CONE = Field("cone", 1e-3, math.pi)
_BLEND = Field("blend", 0.0, 1.0)


@dataclass(frozen=True, kw_only=True)
class _Linked:
    """A lamp whose light has a linking, 0 to 63: of the lamina.Occluders, those of this linking take its light and
    reflect it; by default all. Raises ArgumentError."""

    linking: int = 0

    def __post_init__(self):
        _set(self, linking=check_whole(self.linking, "linking", 0, MOST_LINKINGS - 1))


@dataclass(frozen=True)
class Lamp(_Linked):
    """A distant lamp with irradiance 1 on a plane perpendicular to its direction. `towards`: direction to the lamp, any
    length above 0. `angle`: angular radius of the lamp's disc in radians, [0, 1]. `linking` of this and of other lamps:
    0 to 63, see lamina.Occluders. Raises ArgumentError."""

    towards: Sequence[float]
    angle: float = 0.0

    kind: ClassVar[str] = "distant"

    def __post_init__(self):
        super().__post_init__()
        _set(self, towards=_direction(self.towards, "towards"), angle=check_field(self.angle, _ANGLE))

    @property
    def too_small(self) -> str:
        """What is wrong with the lamp behind a smooth boundary, or ""."""
        return f"angle = {self.angle:g}: must be at least {LEAST_DISC:.3g}" if self.angle < LEAST_DISC else ""

    def in_core(self, layer, _centre):
        return layer.Lamp.distant(self.towards, math.cos(self.angle))

    @property
    def places(self) -> tuple:
        """Some places of a lamp that is not far away, mm."""
        return ()


@dataclass(frozen=True)
class PointLamp(_Linked):
    """A sphere that shines evenly, with irradiance 1 at a distance of 1 m from its centre. `position`: of the centre,
    mm. `radius`: mm, [0, 1e12]. Raises ArgumentError."""

    position: Sequence[float]
    radius: float = 0.0

    kind: ClassVar[str] = "point"

    def __post_init__(self):
        super().__post_init__()
        _set(self, position=_three(self.position, "position"), radius=check_field(self.radius, _RADIUS))

    @property
    def too_small(self) -> str:
        return "radius = 0: must be above 0" if self.radius == 0.0 else ""

    def in_core(self, layer, centre):
        return layer.Lamp.sphere(_moved(self.position, centre), self.radius)

    @property
    def places(self) -> tuple:
        return (self.position,)


@dataclass(frozen=True)
class SpotLamp(_Linked):
    """A PointLamp that shines into a cone. `direction`: along which the lamp shines, any length above 0. `cone`: the
    whole angle of the cone in radians, [0.001, pi]. `blend`: [0, 1], the part of the cone over which the light falls to
    0, as in Blender. Raises ArgumentError."""

    position: Sequence[float]
    direction: Sequence[float]
    cone: float
    blend: float = 0.0
    radius: float = 0.0

    kind: ClassVar[str] = "spot"

    def __post_init__(self):
        super().__post_init__()
        _set(self, position=_three(self.position, "position"), direction=_direction(self.direction, "direction"),
             cone=check_field(self.cone, _CONE), blend=check_field(self.blend, _BLEND),
             radius=check_field(self.radius, _RADIUS))

    @property
    def too_small(self) -> str:
        return "radius = 0: must be above 0" if self.radius == 0.0 else ""

    def in_core(self, layer, centre):
        return layer.Lamp.spot(_moved(self.position, centre), self.radius, self.direction, math.cos(0.5 * self.cone),
                               self.blend)

    @property
    def places(self) -> tuple:
        return (self.position,)


@dataclass(frozen=True)
class AreaLamp(_Linked):
    """A rectangle or an ellipse of radiance 1 that shines to one side. `position`: of the centre, mm. `first`,
    `second`: from the centre to the middle of two edges in mm, perpendicular to each other; the lamp shines to the side
    of first x second. Raises ArgumentError."""

    position: Sequence[float]
    first: Sequence[float]
    second: Sequence[float]
    ellipse: bool = False

    kind: ClassVar[str] = "area"
    too_small: ClassVar[str] = ""

    def __post_init__(self):
        super().__post_init__()
        first, second = _three(self.first, "first"), _three(self.second, "second")
        lengths = np.linalg.norm(first), np.linalg.norm(second)
        if not (min(lengths) > 0.0 and abs(np.dot(first, second)) <= 1e-3 * lengths[0] * lengths[1]):
            raise ArgumentError(f"second = {quoted(self.second)}: must be perpendicular to first, and both must have a "
                                "length")
        _set(self, position=_three(self.position, "position"), first=first, second=second, ellipse=bool(self.ellipse))

    def in_core(self, layer, centre):
        return layer.Lamp.area(_moved(self.position, centre), self.first, self.second, self.ellipse)

    @property
    def places(self) -> tuple:
        middle, first, second = map(np.array, (self.position, self.first, self.second))
        return (middle, *(middle + side * edge for edge in (first, second) for side in (-1.0, 1.0)))


AnyLamp = Lamp | PointLamp | SpotLamp | AreaLamp
KINDS: dict[str, type] = {cls.kind: cls for cls in (Lamp, PointLamp, SpotLamp, AreaLamp)}


@dataclass(frozen=True, eq=False)
class Surroundings:
    """The radiance of the surroundings by direction. `radiance`: (rows, columns, 3), 0 or more, constant in each cell.
    Rows go from -z to +z, evenly in angle; columns go from azimuth pi down to -pi, where azimuth 0 is +x and pi / 2 is
    +y. Cycles has the same convention for equirectangular images, with the first row at the bottom. Small bright spots,
    as an image of the sun, make much noise: use a lamp for them. Raises ArgumentError."""

    radiance: np.ndarray

    def __post_init__(self):
        table = finite_array(self.radiance, "radiance")
        if table.ndim != 3 or table.shape[2] != 3 or not table.size:
            raise ArgumentError(f"radiance has the shape {table.shape}: must be (rows, columns, 3)")
        if table.min() < 0.0:
            raise ArgumentError(f"radiance = {table.min():g}: must be 0 or more")
        _set(self, radiance=np.ascontiguousarray(table, np.float32))

    @property
    def hash(self) -> str:
        """Hash of the content: equal surroundings have equal hashes."""
        return hashlib.sha256(f"{self.radiance.shape}".encode() + self.radiance.tobytes()).hexdigest()


def to_json(lamp: AnyLamp) -> dict:
    """A plain object for json.dump. The usual linking is left out."""
    return {"kind": lamp.kind, **{name: list(value) if isinstance(value, tuple) else value
                                  for name, value in asdict(lamp).items() if name != "linking" or value}}


def from_json(data: dict) -> AnyLamp:
    """Inverse of to_json. Raises KeyError, TypeError or ArgumentError for other data."""
    cls = KINDS[data["kind"]]
    return cls(**{one.name: data[one.name] for one in fields(cls) if one.name in data})


def _set(lamp, **values) -> None:
    for name, value in values.items():
        object.__setattr__(lamp, name, value)


def _three(values, name: str) -> tuple[float, ...]:
    found = finite_array(values, name)
    if found.shape != (3,):
        raise ArgumentError(f"{name} = {quoted(values)}: must be three numbers")
    return tuple(map(float, found))


def _direction(values, name: str) -> tuple[float, ...]:
    found = finite_array(values, name)
    length = float(np.linalg.norm(found)) if found.shape == (3,) else 0.0
    if not length > 0.0:
        raise ArgumentError(f"{name} = {quoted(values)}: must be three numbers, not all 0")
    return tuple(map(float, found / length))


def _moved(position, centre: np.ndarray) -> tuple[float, ...]:
    """A position relative to the centre of the solid, as the core has it."""
    return tuple(map(float, np.array(position) - centre))
