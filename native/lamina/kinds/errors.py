# SPDX-License-Identifier: GPL-3.0-or-later
"""The errors of bad input, and how their messages quote a value."""

from __future__ import annotations

import reprlib

LONGEST = 60  # characters of one value in a sentence


class StackError(ValueError):
    """A bad stack: names the field, its value and the allowed range."""


class DustError(ValueError):
    """Bad options or meshes for dust: names the field, its value and the allowed range."""


class _Short(reprlib.Repr):
    """repr() of a value, without the middle if it is long."""

    def __init__(self):
        super().__init__()
        self.maxstring = self.maxlong = self.maxother = LONGEST

    def repr_tuple(self, x, level):
        return self.repr_list(x, level)  # most tuples were lists where they were given (see hashable)

    def repr_int(self, x, level):
        try:
            return super().repr_int(x, level)
        except ValueError:  # Python refuses to write out thousands of digits
            return f"a number of {x.bit_length()} bits"


def quoted(value) -> str:
    """A value for a message: on one line, with at most about LONGEST characters."""
    return clipped(_Short().repr(value))


def clipped(text: str) -> str:
    """A text on one line, without the middle if it is long."""
    if len(text) > 2 * LONGEST:
        text = f"{text[:LONGEST]}...{text[-LONGEST // 2:]}"
    return " ".join(text.split())
