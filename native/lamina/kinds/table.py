# SPDX-License-Identifier: GPL-3.0-or-later
"""The strips of a lookup table, which its writer and the node group share, and the size of its axes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

COLUMNS = 64  # view angles
TAU_ROWS = 33  # thicknesses of a varying layer
# Rows are uniform in t = tau / (tau + TAU_BEND), which gives the most rows to thin layers, where values change fastest.
TAU_BEND = 0.5
ROUGHNESS_ROWS = 6  # roughnesses of a table, if roughness is an input

# Roles of strips that hold the weights of a closure: for light that no color changes; for light that a colored base
# adds, whose weights depend on the reflectance; of a Principled base below an interface, see baking.bases.covered,
# for light that does not depend on the base's color, for light that the base reflects once, and repeatedly.
OWN, BASE = "", "base/"
DARK, FIRST, AGAIN = "dark/", "first/", "again/"
# Roles of strips without a closure: the share of diffuse light from the base that the layers reflect back to it; the
# weight of a base that another shader renders, see baking.bases.shader; the weight of the Principled BSDF itself, which
# has the sockets' values; and the share of trapped light that a metal keeps in.
THROWN_BACK, BASE_WEIGHT, PRINCIPLED, TRAPPED = "base/thrown back", "base/weight", "principled", "metal/trapped"

# The roles of strips that hold the shape of a closure "moving:N" in place of R G B, see closures.moving_lobes, and of
# one "oriented:N", whose shape needs two strips, see closures.oriented_lobes.
SHAPE, TILT = "shape/", "tilt/"
# Azimuths of the view, from the layer's tangent to half a turn: rows of the table of an anisotropic stack. Facets look
# the same after half a turn, so the last row equals the first.
AZIMUTH_ROWS = {"preview": 13, "final": 33}
# With a varying layer too, the table has these many thicknesses for each azimuth.
TAU_ROWS_OF_AZIMUTH = 17

_WITHOUT_CLOSURE = (THROWN_BACK, BASE_WEIGHT, PRINCIPLED)
_METAL = "metal/"


@dataclass(frozen=True)
class Strip:
    """What one strip of a table holds. `closure`: the id of the closure whose weights or shapes it holds, or "" for a
    role without a closure. `metal`: it belongs to a base of metallic 1, if metallic is an input; the other strips are
    then for metallic 0."""

    closure: str = ""
    role: str = OWN
    metal: bool = False

    @classmethod
    def of(cls, name: str) -> Strip:
        """The strip with this name in the header of a table."""
        if name == TRAPPED:
            return cls(role=TRAPPED)
        rest = name.removeprefix(_METAL)
        roles = _WITHOUT_CLOSURE if rest in _WITHOUT_CLOSURE else (BASE, DARK, FIRST, AGAIN, SHAPE, TILT)
        role = next((role for role in roles if rest.startswith(role)), OWN)
        return cls(rest.removeprefix(role), role, name != rest)

    @property
    def name(self) -> str:
        """The name in the header of a table."""
        return _METAL * self.metal + self.role + self.closure

    @property
    def is_weight(self) -> bool:
        """True if it holds the weights of a closure."""
        return bool(self.closure) and self.role not in (SHAPE, TILT)


def strips_of(header: dict) -> list[Strip]:
    """The strips of the table with this header, in order."""
    return [Strip.of(name) for name in header["closures"]]


def closure_count(header: dict) -> int:
    """The number of strips of the table with this header, without those that hold the shapes of closures."""
    return sum(strip.role not in (SHAPE, TILT) for strip in strips_of(header))


def is_covered(strips: Iterable[Strip]) -> bool:
    """True if a table with these strips is that of a Principled base with inputs below an interface."""
    return any(strip.role == DARK for strip in strips)
