# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields: every physical quantity of a stack is one number, or one per channel, within a range.

A Field is a quantity, a Rare one that JSON usually omits. A Form is a set of quantities that together describe a thing.
An Option is a choice."""

from __future__ import annotations

import json
import math
import numbers
import statistics
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from typing import cast

from .errors import StackError, clipped, quoted
from .panel import Item, Panel

Channels = float | Sequence[float]


@dataclass(frozen=True)
class Field:
    """A quantity: its name, its range [low, high] and its unit. `above`: the lower end is not part of the range.
    `whole`: a whole number. `infinite`: infinity is allowed too. `optional`: may be missing from a form. `single`: one
    number for all channels, or a list of equal numbers. `rule`: the range in words, if not made from the numbers.
    `panel`: how the panel shows it, or None if the panel does not."""

    name: str
    low: float
    high: float
    unit: str = ""
    above: bool = False
    whole: bool = False
    infinite: bool = False
    optional: bool = False
    single: bool = False
    rule: str = ""
    panel: Panel | None = None

    def __post_init__(self):
        if not self.rule:
            object.__setattr__(self, "rule", self._range_in_words())

    def _range_in_words(self) -> str:
        if self.whole:
            return f"must be a whole number from {self.low:.0f} to {self.high:.0f} {self.unit}".rstrip()
        return f"must lie in {'(' if self.above else '['}{_end(self.low)}, {_end(self.high)}] {self.unit}".rstrip()

    @property
    def prop(self) -> str:
        """The name of the add-on's property."""
        return self.panel.prop or self.name if self.panel else self.name

    def contains(self, number: float) -> bool:
        """True if a number is in the range."""
        if number == math.inf:
            return self.infinite
        above = self.low < number if self.above else self.low <= number
        return above and number <= self.high and (not self.whole or number == int(number))

    def check(self, value, path: str) -> float | tuple[float, ...]:
        """`value` as a float or a tuple of floats, one per channel.

        Raises StackError, naming `path`, for anything else or out of range."""
        if isinstance(value, str) and value == "inf":
            value = math.inf
        if isinstance(value, numbers.Real) and not isinstance(value, bool):
            return self._check_number(_to_float(value, path), path)
        if hasattr(value, "tolist"):
            value = value.tolist()
            if not isinstance(value, list):
                return self.check(value, path)
        if isinstance(value, list | tuple) and self.single and value and all(item == value[0] for item in value):
            return self.check(value[0], path)
        if isinstance(value, list | tuple) and not self.single:
            if not value:
                raise StackError(f"{path} = []: must hold one number per channel")
            items = [math.inf if isinstance(item, str) and item == "inf" else item for item in value]
            for index, item in enumerate(items):
                if isinstance(item, bool) or not isinstance(item, numbers.Real):
                    raise StackError(f"{path}[{index}] = {quoted(item)}: must be a number")
            return tuple(self._check_number(_to_float(x, path), f"{path}[{i}]") for i, x in enumerate(items))
        words = "one number for all channels" if self.single else "a number or one number per channel"
        raise StackError(f"{path} = {quoted(value)}: must be {words}")

    def _check_number(self, number: float, path: str) -> float:
        if not self.contains(number):
            raise StackError(f"{path} = {repr(number).removesuffix('.0')}: {self.rule}")
        return number + 0.0  # -0.0 and 0.0 are one value


@dataclass(frozen=True)
class Rare:
    """A quantity, one number for all channels, that most things leave at its `usual` value. JSON omits that value."""

    field: Field
    usual: float | None

    @property
    def name(self) -> str:
        return self.field.name

    def check(self, value, path: str) -> float | None:
        """The value as a float, or the usual value. Raises StackError, naming `path`."""
        return None if value is None and self.usual is None else cast(float, self.field.check(value, path))


@dataclass(frozen=True)
class Option:
    """A choice. `values`: the allowed values, the usual one first. `items`: entries of the panel's list, for texts.
    `several`: the value is a tuple of ids of `items`, in any order, and `values` is the usual tuple."""

    name: str
    values: tuple
    label: str
    tip: str
    items: tuple[Item, ...] = ()
    several: bool = False

    optional = False  # in a form

    @property
    def prop(self) -> str:
        """The name of the add-on's property."""
        return self.name

    @property
    def usual(self):
        """The value of a thing that does not choose."""
        return self.values if self.several else self.values[0]

    def plain(self, value):
        """JSON form of a checked value."""
        return list(value) if self.several else value

    def check(self, value, path: str):
        """The value, several ids as a tuple in the order of `items`. Raises StackError, naming `path`, unless it is
        allowed."""
        if self.several:
            known = [item.id for item in self.items]
            given = value if isinstance(value, list | tuple | set | frozenset) else [value]
            for name in given:
                if name not in known:
                    raise StackError(f"{path} = {quoted(value)}: must be a list of names among {', '.join(known)}")
            return tuple(name for name in known if name in given)
        if type(value) is not type(self.values[0]) or value not in self.values:
            words = " or ".join(json.dumps(choice) for choice in self.values)
            raise StackError(f"{path} = {quoted(value)}: must be {words}")
        return value


@dataclass(frozen=True)
class Form:
    """Quantities that together describe a thing; an Option names a substance. `item`: the form's entry in the panel's
    list, or None if the panel has no such list. `local`: the quantities of a medium that scatter or absorb, which may
    change with depth."""

    fields: tuple[Field | Option, ...]
    item: Item | None = None
    local: tuple[Field | Option, ...] = ()

    def __iter__(self):
        return iter(self.fields)


def _end(number: float) -> str:
    """One end of a range, as messages write it: 1e12, not 1e+12."""
    return "infinity" if number == math.inf else f"{number:g}".replace("e+", "e")


def _to_float(number: numbers.Real | float, path: str) -> float:
    try:
        return float(number)
    except OverflowError:
        raise StackError(f"{path}: must be a number that fits into 64 bits") from None


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


def channel(value: Channels | None, index: int) -> float:
    """The value of a checked quantity in one channel."""
    return value[index] if isinstance(value, tuple) else cast(float, value)


def mean(value: Channels) -> float:
    """A checked quantity's mean over channels."""
    return value if isinstance(value, int | float) else statistics.fmean(value)


def as_channels(values: Sequence[float]) -> Channels:
    """A quantity from its values in all channels: of one channel a number, otherwise a tuple."""
    return tuple(values) if len(values) > 1 else values[0]


def all_fields(thing) -> list[Field | Option]:
    """Every quantity of a layer or base once: those of its forms, then the others."""
    named = {quantity.name: quantity for form in getattr(thing, "forms", ()) for quantity in form}
    return [*named.values(), *thing.fields]


def panel_fields(cls: type, owner) -> tuple[Field, ...]:
    """The quantities to edit for a thing of the kind `cls` with the properties of `owner`: those of its form, then the
    others."""
    for form in getattr(cls, "forms", ()):
        if form.item is not None and form.item.id == getattr(owner, cls.form_prop):  # type: ignore[attr-defined]
            return *form, *cls.fields  # type: ignore[attr-defined]
    return cls.fields  # type: ignore[attr-defined]


def check_forms(thing, path: str) -> dict[str, float | tuple[float, ...]]:
    """The checked values of the one form in which `thing` is given.

    Raises StackError if no form, two forms or an incomplete form is given."""
    names = [{quantity.name for quantity in form} for form in thing.forms]
    present = {quantity.name for quantity in all_fields(thing) if getattr(thing, quantity.name) is not None}
    present &= set().union(*names)
    words = " or ".join(", ".join(q.name for q in form if not q.optional) for form in thing.forms)
    if not present:
        raise StackError(f"{path} has no coefficients: must have either {words}")
    fitting = [form for form, known in zip(thing.forms, names, strict=True) if present <= known]
    if not fitting:
        raise StackError(f"{path} has two forms: must have either {words}")
    values = {}
    for quantity in fitting[0]:
        value = getattr(thing, quantity.name)
        if value is not None:
            values[quantity.name] = quantity.check(value, f"{path}.{quantity.name}")
        elif not quantity.optional:
            raise StackError(f"{path}.{quantity.name} is missing: must have either {words}")
    return values


def to_plain(value: Channels):
    """JSON form: infinity is the string 'inf'."""
    if isinstance(value, tuple):
        return [to_plain(item) for item in value]
    return "inf" if value == math.inf else value


def check_table(value, path: str, low: float, high: float, rule: str, most: int):
    """A list of 1 to `most` numbers in [low, high] as a tuple of floats, or a list of such lists, one per channel,
    as a tuple of tuples.

    Raises StackError, naming `path`, for anything else."""
    value = value.tolist() if hasattr(value, "tolist") else value
    if not isinstance(value, list | tuple) or not 1 <= len(value) <= most:
        count = f" has {len(value)} entries" if isinstance(value, list | tuple) else f" = {quoted(value)}"
        raise StackError(f"{path}{count}: must be a list of 1 to {most} numbers, or one list per channel")
    rows = [row.tolist() if hasattr(row, "tolist") else row for row in value]
    if isinstance(rows[0], list | tuple):
        for index, row in enumerate(rows):
            if not isinstance(row, list | tuple) or (row and isinstance(row[0], list | tuple)):
                raise StackError(f"{path}[{index}]: must be a list of numbers")
        return tuple(check_table(row, f"{path}[{i}]", low, high, rule, most) for i, row in enumerate(rows))
    number = Field(path, low, high, rule=rule)
    for index, item in enumerate(rows):
        if isinstance(item, bool) or not isinstance(item, numbers.Real):
            raise StackError(f"{path}[{index}] = {quoted(item)}: must be a number")
    return tuple(number.check(item, f"{path}[{index}]") for index, item in enumerate(rows))


def check_keys(entry, allowed: Set[str], path: str, required: Set[str] = frozenset()) -> None:
    """Raises StackError unless `entry` is a JSON object with all required keys and no keys that are not allowed."""
    if not isinstance(entry, Mapping):
        raise StackError(f"{path} = {quoted(entry)}: must be a JSON object")
    for key in entry:
        if key not in allowed:
            raise StackError(f"{path}.{clipped(str(key))}: unknown key; known are {', '.join(sorted(allowed))}")
    for key in sorted(required):
        if key not in entry:
            raise StackError(f"{path}.{key} is missing: must be given")


def read_kind(entry, path: str) -> str:
    """The entry's "kind". Raises StackError if it is missing."""
    if not isinstance(entry, Mapping):
        raise StackError(f"{path} = {quoted(entry)}: must be a JSON object")
    if "kind" not in entry:
        raise StackError(f"{path}.kind is missing: must be given")
    return entry["kind"]
