# SPDX-License-Identifier: GPL-3.0-or-later
"""The library of stacks that comes with Lamina."""

from .material.presets import Preset, entries, load, names

__all__ = ["Preset", "entries", "load", "names"]
