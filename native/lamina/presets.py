# SPDX-License-Identifier: GPL-3.0-or-later
"""The library of stacks that comes with Lamina, and stacks that the user has saved under a name."""

from .material.presets import Preset, entries, load, names
from .material.user_presets import delete, load_user, save, user_folder, user_names

__all__ = ["Preset", "delete", "entries", "load", "load_user", "names", "save", "user_folder", "user_names"]
