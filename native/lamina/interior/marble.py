# SPDX-License-Identifier: GPL-3.0-or-later
"""Procedural marble: turbulent veins, as mixtures of end materials."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass

import numpy as np

from ..common import json_file
from ..common.arguments import check_field, check_path, finite_array
from ..common.atomic import write_atomically
from ..common.errors import ArgumentError, InteriorError, quoted
from ..common.progress import Progress, stepper
from ..kinds.interiors import DIRECTION, GROUND, MARBLE, VEINS, VOXELS, defaults
from .end_material import EndMaterial
from .grid import MOST_COORDINATE, Interior, checked_box, checked_palette
from .noise import turbulence

FORMAT, SCHEMA = "lamina-marble", 1
WHITE, VEIN = EndMaterial(**defaults(GROUND)), EndMaterial(**defaults(VEINS))
_DEFAULTS = defaults(MARBLE)


@dataclass(frozen=True)
class Marble:
    """Veins in parallel planes, distorted by turbulence (Perlin 1985). Lengths in mm. Raises InteriorError.

    `palette`: 2 to 256 lamina.EndMaterial, from the ground to the middle of a vein.
    `spacing`: distance between planes. `direction`: normal of the planes, any length above 0.
    `width`: width of veins relative to the spacing, [0.001, 1]. The mixture falls as
    exp(-(2 d / (width spacing))^2) with the distance d from the middle of a vein.
    `distortion`: displacement of the planes by a turbulence of 1, in spacings, [0, 100]. `feature`: size of the
    largest distortions.
    `octaves`: 1 to 12; each has `lacunarity` times the frequency and `gain` times the weight of the previous octave.
    `seed`: seed of the noise."""

    palette: Sequence[EndMaterial] = (WHITE, VEIN)
    spacing: float = _DEFAULTS["spacing"]
    direction: Sequence[float] = DIRECTION
    width: float = _DEFAULTS["width"]
    distortion: float = _DEFAULTS["distortion"]
    feature: float = _DEFAULTS["feature"]
    octaves: int = _DEFAULTS["octaves"]
    lacunarity: float = 2.0
    gain: float = 0.5
    seed: int = _DEFAULTS["seed"]

    def __post_init__(self):
        try:
            for field in MARBLE:
                object.__setattr__(self, field.name, check_field(getattr(self, field.name), field))
            direction = finite_array(self.direction, "direction")
        except ArgumentError as error:
            raise InteriorError(str(error)) from None
        if direction.shape != (3,) or not np.linalg.norm(direction) > 0.0:
            raise InteriorError(f"direction = {quoted(self.direction)}: must be three numbers, not all 0")
        object.__setattr__(self, "direction", tuple(map(float, direction)))
        object.__setattr__(self, "palette", checked_palette(self.palette))
        if len(self.palette) < 2:
            raise InteriorError("palette holds one material: must hold a ground and a vein")

    def coordinate(self, places) -> np.ndarray:
        """The mixture coordinate at positions in mm, shape (..., 3): 0 in the ground, 1 in the middle of a vein."""
        places = np.asarray(places, float)
        across = np.array(self.direction) / (np.linalg.norm(self.direction) * self.spacing)
        shift = turbulence(places / self.feature, self.octaves, self.lacunarity, self.gain, self.seed)
        phase = places @ across + self.distortion * shift
        away = np.abs(phase - np.rint(phase))  # distance to the middle of the nearest vein, in spacings
        return np.exp(-((2.0 * away / self.width) ** 2))

    def to_json(self) -> dict:
        """A plain object for json.dump."""
        values = asdict(self) | {"palette": [one.to_json() for one in self.palette], "direction": list(self.direction)}
        return {"format": FORMAT, "schema": SCHEMA, **values}

    @classmethod
    def from_json(cls, data) -> Marble:
        """Inverse of to_json; missing fields have their defaults. Raises InteriorError."""
        if not isinstance(data, dict) or data.get("format") != FORMAT:
            raise InteriorError(f"not a marble of Lamina: format must be {FORMAT!r}")
        if data.get("schema") != SCHEMA:
            raise InteriorError(f"schema = {quoted(data.get('schema'))}: must be {SCHEMA}")
        values = {key: value for key, value in data.items() if key not in ("format", "schema")}
        unknown = sorted(set(values) - set(cls.__dataclass_fields__))
        if unknown:
            raise InteriorError(f"{quoted(unknown[0])}: must be one of {', '.join(cls.__dataclass_fields__)}")
        if "palette" in values:
            if not isinstance(values["palette"], list):
                raise InteriorError(f"palette = {quoted(values['palette'])}: must be a list")
            values["palette"] = [EndMaterial.from_json(one, f"palette[{k}]") for k, one in enumerate(values["palette"])]
        return cls(**values)

    def save(self, path: str | os.PathLike) -> None:
        """Writes a JSON file atomically. Raises OSError."""
        text = json.dumps(self.to_json(), indent=1) + "\n"
        write_atomically(path, lambda file: file.write(text.encode()))

    @classmethod
    def load(cls, path: str | os.PathLike) -> Marble:
        """Reads a file written by `save`. Raises InteriorError with the file's name, or OSError."""
        path = check_path(path)
        try:
            return cls.from_json(json_file.parse(path.read_text(encoding="utf-8")))
        except ValueError as error:
            raise InteriorError(f"{path}: {error}") from None


def marble(low, high, voxels: int = 128, veins: Marble | None = None, progress: Progress | None = None,
           cancel: Callable[[], bool] | None = None) -> Interior:
    """An Interior of marble in a box with the corners `low` and `high`, mm. `voxels`: number along the longest side, 1
    to 1024; voxels are nearly cubes. `veins`: a lamina.Marble. Results are identical on every machine.
    `progress(fraction, text)` reports progress. `cancel()` is called often; if it returns true, Cancelled is raised.
    Raises InteriorError, ArgumentError, Cancelled."""
    low, high = checked_box(low, high)
    veins = Marble() if veins is None else veins
    if not isinstance(veins, Marble):
        raise ArgumentError(f"veins = {quoted(veins)}: must be a lamina.Marble")
    check_field(voxels, VOXELS)
    step = stepper("the marble", progress, cancel)
    sides = np.array(high) - low
    counts = [max(1, math.ceil(voxels * side / sides.max() - 1e-9)) for side in sides]
    x, y, z = (low[axis] + sides[axis] * (np.arange(count) + 0.5) / count for axis, count in enumerate(counts))
    found = np.empty(counts, np.uint16)
    for row, place in enumerate(x):
        step(row / len(x), "Veins")
        places = np.stack(np.broadcast_arrays(place, y[:, None], z[None]), axis=-1)
        found[row] = np.rint(veins.coordinate(places) * MOST_COORDINATE)
    step(1.0, "Done")
    return Interior(found, low, high, tuple(veins.palette))
