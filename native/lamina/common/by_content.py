# SPDX-License-Identifier: GPL-3.0-or-later
"""Equality and hashes by content, for dataclasses that hold arrays."""

from __future__ import annotations

import dataclasses

import numpy as np


class ByContent:
    """A frozen dataclass with eq=False: objects are equal if their fields are, arrays bit by bit, and equal objects
    have equal hashes. Fields with compare=False do not count. A subclass is a dataclass."""

    def __eq__(self, other) -> bool:
        return type(self) is type(other) and self._content() == other._content()

    def __hash__(self) -> int:
        return hash(self._content())

    def _content(self) -> tuple:
        fields = dataclasses.fields(self)  # type: ignore[arg-type]  # the subclass is a dataclass
        return tuple(_key(getattr(self, one.name)) for one in fields if one.compare)


def _key(value):
    """A hashable object that is equal for equal values only."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, dict):
        return tuple(sorted((str(name), _key(one)) for name, one in value.items()))
    if isinstance(value, list | tuple):
        return tuple(_key(one) for one in value)
    return value
