# SPDX-License-Identifier: GPL-3.0-or-later
"""The errors that Lamina raises on purpose. Each message is one sentence, fit to be shown to a user."""

from __future__ import annotations

import difflib
import reprlib

LONGEST = 60  # characters of one value in a sentence


class _Short(reprlib.Repr):
    """Python's own form of a value, with the middle left out where that is long."""

    def __init__(self):
        super().__init__()
        self.maxstring = self.maxlong = self.maxother = LONGEST

    def repr_int(self, x, level):
        try:
            return super().repr_int(x, level)
        except ValueError:  # Python refuses to write out thousands of digits
            return f"a number of {x.bit_length()} bits"


def shown(value) -> str:
    """A value as sentences show it, on one line and about LONGEST characters long at most."""
    return clipped(_Short().repr(value))


def clipped(text: str) -> str:
    """A text on one line, with the middle left out where it is long."""
    if len(text) > 2 * LONGEST:
        text = f"{text[:LONGEST]}...{text[-LONGEST // 2:]}"
    return " ".join(text.split())


class ArgumentError(ValueError):
    """An argument of a function that cannot be: names the argument, its value and the allowed range."""


class StackError(ValueError):
    """A stack that cannot be: names the field, its value and the allowed range."""


class UnknownName(StackError, KeyError):  # noqa: N818 - reads as what it says
    """A preset or metal that is not in the library; names those nearest to it."""

    __str__ = Exception.__str__  # a KeyError would quote the sentence


def unknown(what: str, name, known: list[str]) -> UnknownName:
    """The error that says so, for a `what` called `name`."""
    nearest = difflib.get_close_matches(str(name)[:LONGEST], known, n=3, cutoff=0.0)
    return UnknownName(f"{what} = {shown(name)}: unknown; the nearest of {len(known)} are {', '.join(nearest)}")


class LutError(ValueError):
    """A lookup table that cannot be read: truncated, foreign, or of a newer schema."""


class ExportError(ValueError):
    """An exported scattering function that cannot be read: truncated, foreign, or of a newer schema."""


class SolveError(RuntimeError):
    """A solve that missed its tolerance at the finest resolution; carries the numbers."""


class ShardError(ValueError):
    """A part of an estimate that cannot be read, or that belongs to another one."""


class DustError(ValueError):
    """Dust that cannot settle: names the field, its value and the allowed range."""


class DustUnavailable(RuntimeError):  # noqa: N818 - reads as what it says
    """There is no working layer of rays in this installation; says why."""


class MeshFileError(ValueError):
    """A mesh file that cannot be read."""


class Cancelled(Exception):  # noqa: N818 - an outcome that the caller asked for, not an error
    """The caller's `cancel` said yes; nothing was written."""
