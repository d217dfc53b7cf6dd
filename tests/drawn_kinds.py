# SPDX-License-Identifier: GPL-3.0-or-later
"""Random phase functions and bases of every kind, from the descriptions of their fields. A kind that is added to
lamina.kinds is in all tests that use this file."""

from __future__ import annotations

import random
from collections.abc import Callable

import numpy as np
from measured_tables import facets, measured

from lamina.kinds.fields import Field
from lamina.kinds.measured import TableText


def drawn(cls: type, chance: random.Random):
    """A thing of the kind `cls`, in its first form."""
    fields = (*(next(iter(getattr(cls, "forms", ())), ())), *cls.fields)
    values = {field.name: _number(field, chance) for field in fields}
    if any(isinstance(one, TableText) for one in getattr(cls, "options", ())):
        lobe = facets(chance.uniform(0.1, 0.5), chance.uniform(0.0, 0.8), chance.uniform(0.0, 0.2))
        values["table"] = measured(lobe).table
    return cls(**values)


def of_all(kinds: tuple[type, ...], special: dict[type, Callable], chance: random.Random) -> list[Callable]:
    """Functions without arguments, one for each kind: those of `special`, then drawn() for the kinds without one."""
    return [*special.values(), *((lambda cls=cls: drawn(cls, chance)) for cls in kinds if cls not in special)]


def _number(field: Field, chance: random.Random) -> float:
    """A value at most half the way from the panel's default to an end of the range, and at most 1 above the default:
    far from peaks that are too sharp for a solve."""
    default = float(np.atleast_1d(field.panel.default)[0])
    low, high = 0.5 * (default + field.low), min(0.5 * (default + field.high), default + 1.0)
    return chance.uniform(low, high)
