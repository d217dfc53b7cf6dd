# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers, bases and phase functions that can be hashed, whether given with lists, arrays or tuples."""

from __future__ import annotations

import dataclasses


class Hashable:
    """A frozen dataclass whose lists and arrays become tuples, so that equal objects have equal hashes."""

    def __post_init__(self):
        for one in dataclasses.fields(self):  # type: ignore[arg-type]  # each subclass is a dataclass
            value = getattr(self, one.name)
            plain = as_tuples(value)
            if plain is not value:
                object.__setattr__(self, one.name, plain)


def as_tuples(value):
    """Lists, sets and arrays as tuples, with all that they hold; any other value as it is."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, set | frozenset):
        value = sorted(value, key=str)
    return tuple(map(as_tuples, value)) if isinstance(value, list | tuple) else value
