# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of the user: JSON files of stacks in one folder, named like the presets."""

from __future__ import annotations

import os
from pathlib import Path

from .errors import StackError, quoted

VARIABLE = "LAMINA_PRESETS"
SUFFIX = ".json"
LONGEST = 60
FORBIDDEN = '/\\:*?"<>|'
RESERVED = {"con", "prn", "aux", "nul", *(f"{port}{n}" for port in ("com", "lpt") for n in range(1, 10))}


def shared_folder() -> Path | None:
    """The folder that the environment variable LAMINA_PRESETS names, for Python and for Blender, or None."""
    given = os.environ.get(VARIABLE)
    return Path(given) if given else None


def names_in(folder: Path) -> list[str]:
    """Names of the presets in a folder, sorted; empty if the folder cannot be read. The files are not read, so a broken
    file does not hide the others."""
    try:
        found = [path.stem for path in folder.iterdir() if path.suffix == SUFFIX and path.is_file()]
    except OSError:
        return []
    return sorted((name for name in found if not name.startswith(".")), key=str.casefold)


def checked_name(name: str) -> str:
    """The name, trimmed, if it can be a file's name everywhere. Raises StackError."""
    if not isinstance(name, str):
        raise StackError(f"name = {quoted(name)}: must be a text")
    name = " ".join(name.split())
    if not 1 <= len(name) <= LONGEST:
        raise StackError(f"name has {len(name)} characters: must have 1 to {LONGEST}")
    for character in name:
        if character in FORBIDDEN or not character.isprintable():
            raise StackError(f"name = {name!r}: must not contain {character!r}")
    if name[0] == "." or name[-1] == "." or name.split(".")[0].casefold() in RESERVED:
        raise StackError(f"name = {name}: must not start or end with a stop, nor be a device's name")
    return name


def same_name(name: str, names: list[str]) -> str | None:
    """The one of `names` that differs from `name` at most in upper and lower case, or None: many file systems take both
    for one file."""
    return next((one for one in names if one.casefold() == name.casefold()), None)
