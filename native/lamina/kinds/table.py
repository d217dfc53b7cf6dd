# SPDX-License-Identifier: GPL-3.0-or-later
"""Constants of the lookup table that its writer and the node group share."""

from __future__ import annotations

from collections.abc import Collection

COLUMNS = 64  # view angles
TAU_ROWS = 33  # thicknesses of a varying layer
# Rows are uniform in t = tau / (tau + TAU_BEND), which gives the most rows to thin layers, where values change fastest.
TAU_BEND = 0.5
# Strips of a textured base: closures after this prefix, whose weights depend on the reflectance, and the share of
# diffuse light from the base that the layers reflect back to it.
PREFIX = "base/"
THROWN_BACK = "base/thrown back"
# Strip of a base that another shader renders: the weight of that shader, see baking.shader_base.
BASE_WEIGHT = "base/weight"
# Strips of a Principled base: the weight of the BSDF itself, which has the sockets' values; and after this prefix the
# strips for metallic 1, if metallic is an input. The strips without the prefix are then for metallic 0.
PRINCIPLED = "principled"
ROUGHNESS_ROWS = 6  # roughnesses of a table, if roughness is an input
METAL = "metal/"
# Strips of a Principled base below an interface, see baking.covered_principled: closures after these prefixes, for
# light that does not depend on the base's color, for light that the base reflects once, and for light that it reflects
# repeatedly; and the share of trapped light that a metal keeps in.
DARK, FIRST, AGAIN = "dark/", "first/", "again/"
TRAPPED = "metal/trapped"


def is_covered(names: Collection[str]) -> bool:
    """True if a table with these strips is that of a Principled base with inputs below an interface."""
    return any(name.startswith(DARK) for name in names)


def lobe_of(name: str) -> str:
    """The id of the closure behind a strip, or "" for a strip that holds no weight of a closure of the dictionary."""
    if name == TRAPPED:
        return ""
    name = name.removeprefix(METAL)
    if name in (THROWN_BACK, BASE_WEIGHT, PRINCIPLED):
        return ""
    return next((name.removeprefix(one) for one in (PREFIX, DARK, FIRST, AGAIN) if name.startswith(one)), name)
