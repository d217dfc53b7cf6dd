# SPDX-License-Identifier: GPL-3.0-or-later
"""Checked numbers: every physical quantity of a stack is one number or one a channel, within a range."""

from __future__ import annotations

import math
import numbers
from collections.abc import Sequence
from dataclasses import dataclass

from .errors import StackError

Channels = float | Sequence[float]


@dataclass(frozen=True)
class Field:
    """A quantity's name, range and the words that say so. `infinite`: infinity is allowed as well."""

    name: str
    low: float
    high: float
    rule: str
    open_ended: bool = False
    infinite: bool = False

    def check(self, value, path: str) -> float | tuple[float, ...]:
        """`value` as a float or a tuple of floats, one a channel.

        Raises StackError, naming `path`, for anything else or out of range."""
        if isinstance(value, str) and value == "inf":
            value = math.inf
        if isinstance(value, numbers.Real) and not isinstance(value, bool):
            return self._check_number(float(value), path)
        if hasattr(value, "tolist"):
            value = value.tolist()
            if not isinstance(value, list):
                return self.check(value, path)
        if isinstance(value, list | tuple):
            if not value:
                raise StackError(f"{path} = []: must hold one number a channel")
            items = [math.inf if item == "inf" else item for item in value]
            for index, item in enumerate(items):
                if isinstance(item, bool) or not isinstance(item, numbers.Real):
                    raise StackError(f"{path}[{index}] = {item!r}: must be a number")
            return tuple(self._check_number(float(x), f"{path}[{i}]") for i, x in enumerate(items))
        raise StackError(f"{path} = {value!r}: must be a number or one number a channel")

    def _check_number(self, number: float, path: str) -> float:
        if self.infinite and number == math.inf:
            return number
        inside = self.low < number < self.high if self.open_ended else self.low <= number <= self.high
        if not math.isfinite(number) or not inside:
            raise StackError(f"{path} = {number:g}: {self.rule}")
        return number + 0.0  # -0.0 and 0.0 are one value


def channel_count(values: Sequence[tuple[str, float | tuple[float, ...]]]) -> int:
    """The number of channels that (path, value) pairs agree on; single numbers fit any.

    Raises StackError when two lists differ in length."""
    count, first = 1, ""
    for path, value in values:
        if isinstance(value, tuple):
            if first and len(value) != count:
                raise StackError(f"{path} has {len(value)} channels: must have {count} like {first}")
            count, first = len(value), path
    return count


def channel(value: float | tuple[float, ...], index: int) -> float:
    """One channel's value."""
    return value[index] if isinstance(value, tuple) else value


def to_plain(value: float | tuple[float, ...]):
    """JSON form: infinity is the string 'inf'."""
    if isinstance(value, tuple):
        return [to_plain(item) for item in value]
    return "inf" if value == math.inf else value
