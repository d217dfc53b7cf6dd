# SPDX-License-Identifier: GPL-3.0-or-later
"""Templates: stacks in which some numbers are free."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from ..common.arguments import check_number
from ..common.errors import ArgumentError, quoted
from ..kinds.bases import Base
from ..kinds.boundaries import Interface
from ..kinds.films import Film
from ..kinds.hashable import Hashable, as_tuples
from ..material.layers import Medium
from ..material.stack import Stack
from .free import Free, Linear

_PATH = re.compile(r"(base|layers\[(\d+)\])((?:\.[a-z]\w*)*)")


@dataclass(frozen=True, eq=False)
class Template:
    """A stack with free parameters, for lamina.fit: the layers, top first, and the base of a lamina.Stack, in which any
    number may be a Free, or a sum of them with coefficients. Raises StackError, as Stack does, if the stack with the
    starting values, or with all parameters at either end, is not one, and ArgumentError if two parameters have one
    name."""

    layers: Sequence[Medium | Interface | Film]
    base: Base | None = None

    def __post_init__(self):
        object.__setattr__(self, "layers", as_tuples(self.layers))
        if isinstance(self.layers, tuple) and self.layers and self.base is None and isinstance(self.layers[-1], Base):
            object.__setattr__(self, "base", self.layers[-1])
            object.__setattr__(self, "layers", self.layers[:-1])
        names = list(self.parameters)
        frees = self.parameters.values()
        for ends in ("start", "low", "high"):
            self.stack({name: getattr(free, ends) for name, free in zip(names, frees, strict=True)})

    @property
    def parameters(self) -> dict[str, Free]:
        """The free parameters by their names, in the order of the layers. Raises ArgumentError."""
        return named([self])

    def stack(self, values: Mapping[str, float]) -> Stack:
        """The stack in which the parameters have these values, by name. Raises StackError and ArgumentError."""
        names = self.parameters
        if not isinstance(values, Mapping) or not set(names) <= set(values):
            raise ArgumentError(f"values = {quoted(values)}: must be a dict with a number for each of "
                                f"{', '.join(names)}")
        return self.filled({free: check_number(values[name], f"values[{quoted(name)}]", "must be a finite number",
                                               math.isfinite) for name, free in names.items()})

    def filled(self, values: Mapping[Free, float]) -> Stack:
        """The stack in which the parameters have these values. Raises StackError."""
        return Stack(_filled(self.layers, values), _filled(self.base, values))

    def changed(self, changes: Mapping[str, object] | None) -> Template:
        """The template with other parts: `changes` are values by path: "base", "base.reflectance",
        "layers[0].thickness", "layers[1].phase.g". Raises ArgumentError for a path that leads nowhere."""
        changes = check_changes(changes)
        if not changes:
            return self
        parts: dict = {"base": self.base, **dict(enumerate(self.layers))}
        for path, value in changes.items():
            match = _PATH.fullmatch(path) if isinstance(path, str) else None
            if match is None:
                raise ArgumentError(f"changes[{quoted(path)}]: must be 'base', or a path such as 'base.reflectance' or "
                                    "'layers[0].thickness'")
            key = "base" if match[2] is None else int(match[2])
            if key not in parts:
                raise ArgumentError(f"changes[{quoted(path)}]: the template has {len(self.layers)} layers")
            parts[key] = _replaced(parts[key], match[3].split(".")[1:], value, path)
        base = parts.pop("base")
        return Template(tuple(parts.values()), base)


def check_changes(changes: Mapping[str, object] | None) -> Mapping[str, object]:
    """The changes, none for None. Raises ArgumentError unless they are a dict."""
    if isinstance(changes, Mapping | None):
        return changes or {}
    raise ArgumentError(f"changes = {quoted(changes)}: must be a dict of values by path, or None")


def named(templates: Sequence[Template]) -> dict[str, Free]:
    """The parameters of several templates, each once. Raises ArgumentError if two have one name."""
    names: dict[Free, str] = {}
    for template in templates:
        for part, path in ((template.layers, "layers"), (template.base, "base")):
            for place, free in _frees(part, path):
                names.setdefault(free, free.name or place)
    found: dict[str, Free] = {}
    for free, name in names.items():
        if name in found:
            raise ArgumentError(f"name = {quoted(name)}: two free parameters have this name; give each its own, "
                                "or use one object in both places")
        found[name] = free
    return found


def _frees(thing, path: str) -> Iterator[tuple[str, Free]]:
    """(place, parameter) of all parameters in a part of a template."""
    if isinstance(thing, Linear):
        several = len(thing.terms) > 1
        for number, free in enumerate(thing.terms):
            yield f"{path} term {number + 1}" if several else path, free
    elif isinstance(thing, tuple):
        for index, item in enumerate(thing):
            yield from _frees(item, f"{path}[{index}]")
    elif isinstance(thing, Hashable):
        for field in dataclasses.fields(thing):  # type: ignore[arg-type]  # each subclass is a dataclass
            yield from _frees(getattr(thing, field.name), f"{path}.{field.name}")


def _filled(thing, values: Mapping[Free, float]):
    """A part of a template with numbers in place of parameters."""
    if isinstance(thing, Linear):
        return thing.value(values)
    if isinstance(thing, tuple):
        return tuple(_filled(item, values) for item in thing)
    if isinstance(thing, Hashable):
        fields = [field.name for field in dataclasses.fields(thing)]  # type: ignore[arg-type]
        given = {name: getattr(thing, name) for name in fields}
        filled = {name: _filled(value, values) for name, value in given.items()}
        if any(filled[name] is not given[name] and filled[name] != given[name] for name in fields):
            return dataclasses.replace(thing, **filled)  # type: ignore[type-var]
    return thing


def _replaced(thing, names: list[str], value, path: str):
    """A layer or base with the member `names[0]` of the member ... replaced."""
    if not names:
        return as_tuples(value)
    if not isinstance(thing, Hashable) or names[0] not in {
            field.name for field in dataclasses.fields(thing)}:  # type: ignore[arg-type]
        raise ArgumentError(f"changes[{quoted(path)}]: the template has no {names[0]} there")
    inner = _replaced(getattr(thing, names[0]), names[1:], value, path)
    return dataclasses.replace(thing, **{names[0]: inner})  # type: ignore[type-var]
