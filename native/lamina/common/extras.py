# SPDX-License-Identifier: GPL-3.0-or-later
"""Packages that only some of Lamina's functions need: the extras of pyproject.toml."""

from __future__ import annotations

import importlib
from types import ModuleType


class ExtraMissing(ImportError):  # noqa: N818 - clear without the suffix Error
    """A package of an extra is not installed; the message says how to install it."""


def require(module: str, what: str) -> ModuleType:
    """The module `module`, which `what` needs. Raises ExtraMissing."""
    try:
        return importlib.import_module(module)
    except ImportError:
        package = module.partition(".")[0]
        # Not "lamina[EXTRA]": no package index has Lamina, and another project may take the name there.
        raise ExtraMissing(f"{what} needs {package}, which is not installed: pip install {package}") from None
