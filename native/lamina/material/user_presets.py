# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of the user: stacks saved under a name, in a folder of the user's own."""

from __future__ import annotations

import errno
import os
import sys
from pathlib import Path

from ..common.errors import StackError, UnknownName, quoted, unknown
from ..kinds.preset_files import SUFFIX, checked_name, names_in, same_name, shared_folder
from .presets import names as library_names
from .stack import Stack


def user_folder() -> Path:
    """The folder of the user's presets: that of the environment variable LAMINA_PRESETS, or by default
    `~/.local/share/lamina/presets` (Linux, below XDG_DATA_HOME if set), `~/Library/Application Support/Lamina/presets`
    (macOS) or `%APPDATA%\\Lamina\\presets` (Windows). The folder may not exist yet."""
    shared = shared_folder()
    if shared is not None:
        return shared
    if sys.platform == "win32":
        return Path(os.environ.get("APPDATA") or Path.home()) / "Lamina" / "presets"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Application Support" / "Lamina" / "presets"
    return Path(os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share") / "lamina" / "presets"


def user_names() -> list[str]:
    """Names of the user's presets, sorted; empty if the folder cannot be read."""
    return names_in(user_folder())


def load_user(name: str) -> Stack:
    """A preset of the user. Raises UnknownName, a KeyError and StackError, for an unknown name, StackError for a file
    that holds no stack, and OSError."""
    if name not in user_names():
        raise unknown("preset", name, sorted([*library_names(), *user_names()]))
    return Stack.load(user_folder() / (name + SUFFIX))


def save(stack: Stack, name: str, replace: bool = False) -> Path:
    """See lamina.presets.save."""
    name = checked_name(name)
    if same_name(name, library_names()):
        raise StackError(f"name = {name}: must not be the id of a preset of the library")
    taken = same_name(name, user_names())
    if taken is not None and not replace:
        raise StackError(f"name = {name}: there is a preset of this name; choose another, or set replace")
    folder = user_folder()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise NotADirectoryError(errno.ENOTDIR, "must be a folder, for the user's presets", str(folder)) from None
    path = folder / ((taken or name) + SUFFIX)
    stack.save(path)
    return path


def delete(name: str) -> None:
    """Deletes a preset of the user. Raises UnknownName and OSError."""
    if name not in user_names():
        raise UnknownName(f"preset = {quoted(name)}: you have no preset of this name")
    (user_folder() / (name + SUFFIX)).unlink()
