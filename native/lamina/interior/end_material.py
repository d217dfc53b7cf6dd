# SPDX-License-Identifier: GPL-3.0-or-later
"""Homogeneous materials. An interior is a mixture of end materials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..common.arguments import check_field
from ..common.errors import ArgumentError, InteriorError, quoted
from ..kinds.fields import Field
from ..kinds.interiors import SIGMA_A, SIGMA_S, G

CHANNELS = 3


@dataclass(frozen=True)
class EndMaterial:
    """A homogeneous material. `sigma_s`, `sigma_a`: scattering and absorption in 1/mm, [0, 65504], one number or one
    each for red, green and blue. `g`: mean cosine of its Henyey-Greenstein phase function, [-0.999, 0.999]. Raises
    InteriorError, a ValueError."""

    sigma_s: float | Sequence[float]
    sigma_a: float | Sequence[float] = 0.0
    g: float = 0.0

    def __post_init__(self):
        for field in (SIGMA_S, SIGMA_A):
            object.__setattr__(self, field.name, _three(getattr(self, field.name), field))
        object.__setattr__(self, "g", check_g(self.g))

    def to_json(self) -> dict:
        """A plain object for json.dump."""
        return {"sigma_s": list(self.sigma_s), "sigma_a": list(self.sigma_a), "g": self.g}  # type: ignore[arg-type]

    @classmethod
    def from_json(cls, data, name: str) -> EndMaterial:
        """Inverse of to_json; `name` is the name of the material in error messages. Raises InteriorError."""
        if not isinstance(data, dict) or set(data) != {"sigma_s", "sigma_a", "g"}:
            raise InteriorError(f"{name} = {quoted(data)}: must be an object of sigma_s, sigma_a and g")
        try:
            return cls(**data)
        except InteriorError as error:
            raise InteriorError(f"{name}.{error}") from None


def check_g(g) -> float:
    """Check a mean cosine and return it as float. Raises InteriorError."""
    try:
        return check_field(g, G)
    except ArgumentError as error:
        raise InteriorError(str(error)) from None


def _three(values, field: Field) -> tuple[float, ...]:
    try:
        array = np.asarray(values, float)
    except (TypeError, ValueError, OverflowError):
        array = np.array([])
    if array.shape not in ((), (CHANNELS,)):
        raise InteriorError(f"{field.name} = {quoted(values)}: must be one number, or three")
    for value in np.atleast_1d(array):
        if not field.contains(float(value)):
            raise InteriorError(f"{field.name} = {value:g}: {field.rule}")
    return tuple(map(float, np.broadcast_to(array, CHANNELS)))
