# SPDX-License-Identifier: GPL-3.0-or-later
"""The library of stacks that comes with Lamina, and stacks that the user has saved under a name."""

from __future__ import annotations

from pathlib import Path

from .material import user_presets
from .material.any_stack import AnyStack, as_stack
from .material.presets import Preset, entries, load, names
from .material.user_presets import delete, load_user, user_folder, user_names

__all__ = ["Preset", "delete", "entries", "load", "load_user", "names", "save", "user_folder", "user_names"]


def __dir__():
    return __all__


def save(stack: AnyStack, name: str, replace: bool = False) -> Path:
    """Saves a stack as a preset of the user, completely or not at all, and returns the file's path. The folder is made
    if necessary. `name`: 1 to 60 characters that can be a file's name, other than the library's ids. Raises StackError
    for a bad name, and for one that is taken unless `replace` is true; ArgumentError; and OSError."""
    return user_presets.save(as_stack(stack), name, replace)
