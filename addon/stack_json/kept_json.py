# SPDX-License-Identifier: GPL-3.0-or-later
"""Imported JSON that a material stores unchanged, because the panel cannot edit it."""

import functools
import json

UNREADABLE = "unreadable"


@functools.lru_cache(64)
def parsed(text, kind):
    """The dict or list in the text; for damaged JSON, a value that `lamina` refuses.

    The value is shared and must not be changed.
    """
    try:
        data = json.loads(text)
    except (ValueError, RecursionError):
        data = None
    if isinstance(data, kind):
        return data
    return {"kind": UNREADABLE} if kind is dict else UNREADABLE
