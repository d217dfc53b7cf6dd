# SPDX-License-Identifier: GPL-3.0-or-later
"""The library of stacks that comes with Lamina: JSON files in the folder `presets`, one per material."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from ..common import json_file
from ..common.errors import unknown
from .millimetres import has_lengths
from .stack import Stack


@dataclass(frozen=True)
class Preset:
    """A stack of the library: `id` is its file's name, `source` the source of its numbers."""

    id: str
    stack: Stack

    @property
    def name(self) -> str:
        """The name that the panel shows."""
        return self.stack.name

    @property
    def category(self) -> str:
        """The group of presets in the panel."""
        return self.stack.category

    @property
    def source(self) -> str:
        """Where the numbers come from."""
        return self.stack.source

    @property
    def has_lengths(self) -> bool:
        """True if all media of the stack are given in millimetres, as lamina.searchlight needs."""
        return has_lengths(self.stack)


@cache
def _texts() -> dict:
    """The files by id, sorted."""
    found = {entry.name.removesuffix(".json"): entry for entry in files(__package__).joinpath("presets").iterdir()
             if entry.name.endswith(".json")}
    return dict(sorted(found.items()))


def names() -> list[str]:
    """The ids of all presets, sorted."""
    return list(_texts())


def load(id: str) -> Stack:
    """A preset's stack. Raises UnknownName, a KeyError and StackError, for an unknown id, and OSError if the library's
    files are missing."""
    if not isinstance(id, str) or id not in _texts():
        raise unknown("preset", id, names())
    return _load(id)


@cache
def _load(id: str) -> Stack:
    return Stack.from_json(json_file.parse(_texts()[id].read_text(encoding="utf-8")))


def entries() -> list[Preset]:
    """All presets, by id."""
    return [Preset(id, load(id)) for id in names()]
