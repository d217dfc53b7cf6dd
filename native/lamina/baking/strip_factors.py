# SPDX-License-Identifier: GPL-3.0-or-later
"""The factors by which the node group multiplies the strips of a table, at values of the base's inputs."""

from __future__ import annotations

from collections.abc import Callable, Collection

import numpy as np

from ..kinds.table import (
    AGAIN,
    BASE_WEIGHT,
    DARK,
    FIRST,
    METAL,
    PREFIX,
    THROWN_BACK,
    TRAPPED,
    is_covered,
    lobe_of,
)
from .base_light import repeated
from .geometric_series import gain


def strip_factors(names: Collection[str], strip: Callable[[str], np.ndarray], color: np.ndarray,
                  metallic: float) -> dict[str, np.ndarray | float]:
    """The factor of each strip with a closure's weight, by the prefix of the strip's name. `names`: all strips of the
    table; `strip(name)`: texels of one of them, R G B along the last axis; `color`: R G B."""
    if is_covered(names):
        found = _of_covered(names, strip, color, metallic)
    else:
        found = _of_series(names, strip, color, metallic)
    prefixes = {name.removesuffix(lobe_of(name)) for name in names if lobe_of(name)}
    return {prefix: found.get(prefix, 1.0) for prefix in prefixes}


def _of_series(names, strip, color, metallic) -> dict[str, np.ndarray | float]:
    """Factors of a table whose base adds light as a geometric series of its color."""
    has_metal = any(name.startswith(METAL) for name in names)
    shares = {"": 1.0 - metallic, METAL: metallic} if has_metal else {"": 1.0}
    found: dict[str, np.ndarray | float] = {}
    for prefix, share in shares.items():
        found[prefix] = share
        if prefix + THROWN_BACK in names and BASE_WEIGHT not in names:
            found[prefix + PREFIX] = share * gain(color, strip(prefix + THROWN_BACK))
    return found


def _of_covered(names, strip, color, metallic) -> dict[str, np.ndarray | float]:
    """Factors of a Principled base below an interface, see covered_principled and base_light."""
    has_metal = METAL + THROWN_BACK in names
    shares = {"": 1.0 - metallic, METAL: metallic} if has_metal else {"": 1.0}
    found: dict[str, np.ndarray | float] = {}
    for prefix, share in shares.items():
        found[prefix + DARK] = share
        if prefix + THROWN_BACK not in names:
            continue
        back = strip(prefix + THROWN_BACK)
        if has_metal and not prefix:
            back = (1.0 - metallic) * back + metallic * strip(TRAPPED)
        found[prefix + FIRST] = share * color
        found[prefix + AGAIN] = share * repeated(color, back)
    return found
