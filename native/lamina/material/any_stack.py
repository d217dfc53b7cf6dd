# SPDX-License-Identifier: GPL-3.0-or-later
"""Arguments that take a stack: an object, the path of a JSON file, or the id or name of a preset."""

from __future__ import annotations

import os
from pathlib import Path

from ..common.arguments import check_kind
from ..common.errors import ArgumentError, quoted, similar
from . import presets, user_presets
from .stack import Stack

AnyStack = Stack | str | os.PathLike


def as_stack(given: AnyStack) -> Stack:
    """The stack that `given` stands for: a lamina.Stack, the id of a preset of the library, the name of a preset of the
    user, or the path of a JSON file, which ends in .json. Raises ArgumentError, StackError for a file that holds no
    stack, and OSError."""
    if isinstance(given, str) and given in presets.names():
        return presets.load(given)
    if isinstance(given, str) and given in user_presets.user_names():
        return user_presets.load_user(given)
    if isinstance(given, (str, os.PathLike)):
        if Path(given).suffix.lower() != ".json":
            nearest = similar(str(given), [*presets.names(), *user_presets.user_names()])
            meant = f"; similar presets are {', '.join(nearest)}" if nearest else ""
            raise ArgumentError(f"stack = {quoted(str(given))}: must be a lamina.Stack, the id of a preset (see "
                                f"lamina.presets.names()), or the path of a .json file{meant}")
        return Stack.load(given)
    return check_kind(given, "stack", Stack, "a lamina.Stack, the id of a preset, or the path of a .json file")
