# SPDX-License-Identifier: GPL-3.0-or-later
"""Strict JSON: an object must not hold a key twice."""

from __future__ import annotations

import json

from .errors import quoted

MOST_DIGITS = 1000  # Python refuses to read more than 4300


def parse(text: str | bytes):
    """The value of a JSON text. Raises ValueError, with a sentence, for invalid JSON, too deep nesting, and a key that
    an object holds twice."""
    try:
        # Some editors begin a file with a byte order mark.
        return json.loads(text.removeprefix("\ufeff") if isinstance(text, str) else text, object_pairs_hook=_object,
                          parse_int=_whole)
    except RecursionError:
        raise ValueError("nested too deeply") from None


def _whole(digits: str) -> int:
    if len(digits) > MOST_DIGITS:
        raise ValueError(f"a number has {len(digits)} digits: must have at most {MOST_DIGITS}")
    return int(digits)


def _object(pairs: list[tuple[str, object]]) -> dict:
    found = dict(pairs)
    if len(found) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for index, key in enumerate(keys) if key in keys[:index])
        raise ValueError(f"key {quoted(twice)} is given twice in one object")
    return found
