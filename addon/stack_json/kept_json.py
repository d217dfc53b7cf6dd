# SPDX-License-Identifier: GPL-3.0-or-later
"""JSON that a material keeps word for word, because the panel has no numbers for what it says."""

import functools
import json

UNREADABLE = "unreadable"


@functools.lru_cache(64)
def parsed(text, kind):
    """The dict or list that the text holds; for a damaged one something that `lamina` refuses.

    It is shared: read it only.
    """
    try:
        data = json.loads(text)
    except (ValueError, RecursionError):
        data = None
    if isinstance(data, kind):
        return data
    return {"kind": UNREADABLE} if kind is dict else UNREADABLE
