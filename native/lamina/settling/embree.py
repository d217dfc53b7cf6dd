# SPDX-License-Identifier: GPL-3.0-or-later
"""The compiled ray tracing module `_mesh` (Embree), loaded on first use. Without it, everything except ray tracing
still works."""

from __future__ import annotations

from functools import cache

from ..common.errors import DustUnavailable


@cache
def _load():
    """(module, "") or (None, the reason)."""
    try:
        from .. import _mesh
    except ImportError as error:
        if getattr(error, "name", None) == "lamina._mesh" or "_mesh" in str(error) and "cannot import" in str(
                error):
            return None, "dust needs the module lamina._mesh, which this build of Lamina was made without"
        return None, f"dust needs the module lamina._mesh, which cannot be loaded: {error}"
    return _mesh, ""


def layer():
    """The module `_mesh`. Raises DustUnavailable."""
    module, reason = _load()
    if module is None:
        raise DustUnavailable(reason)
    return module


def why_not() -> str:
    """One sentence with the reason why no rays can be traced, or ''."""
    return _load()[1]
