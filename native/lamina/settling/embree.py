# SPDX-License-Identifier: GPL-3.0-or-later
"""The compiled layer of rays (Embree, in the module `_mesh`), which is loaded when it is first needed: without it, or
with a broken one, all that traces no rays works as ever."""

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
    """Empty, or one sentence that says why no rays can be traced."""
    return _load()[1]
