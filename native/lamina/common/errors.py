# SPDX-License-Identifier: GPL-3.0-or-later
"""The errors that Lamina raises. Each message is one sentence that can be shown to a user."""

from __future__ import annotations

import difflib

from ..kinds.errors import LONGEST, DustError, StackError, clipped, quoted

__all__ = ["ArgumentError", "Cancelled", "DustError", "DustUnavailable", "ExportError", "InteriorError", "LutError",
           "MeasurementError", "MeshFileError", "ShardError", "SolveError", "StackError", "UnknownName", "clipped",
           "quoted", "similar", "unknown"]


class ArgumentError(ValueError):
    """A bad argument of a function: names the argument, its value and the allowed range."""


class UnknownName(StackError, KeyError):  # noqa: N818 - clear without the suffix Error
    """A preset or metal that is not in the library; lists the most similar names."""

    __str__ = Exception.__str__  # a KeyError would quote the sentence


def similar(name: str, known: list[str], cutoff: float = 0.6) -> list[str]:
    """The three `known` names most similar to `name`, above the `cutoff` of difflib."""
    return difflib.get_close_matches(name[:LONGEST], known, n=3, cutoff=cutoff)


def unknown(what: str, name, known: list[str]) -> UnknownName:
    """The error for an unknown `what` called `name`."""
    nearest = similar(str(name), known, 0.0)
    return UnknownName(f"{what} = {quoted(name)}: unknown; the nearest of {len(known)} are {', '.join(nearest)}")


class LutError(ValueError):
    """A lookup table that cannot be read: truncated, foreign, or of a newer schema."""


class ExportError(ValueError):
    """An exported scattering function that cannot be read: truncated, foreign, or of a newer schema."""


class MeasurementError(ValueError):
    """A file of measurements that cannot be read: of an unknown format, truncated, or with values that cannot be."""


class SolveError(RuntimeError):
    """A solve missed its tolerance at the finest resolution; the message holds the numbers."""


class ShardError(ValueError):
    """A part of an estimate that cannot be read, or that belongs to another one."""


class DustUnavailable(RuntimeError):  # noqa: N818 - clear without the suffix Error
    """This installation cannot trace rays; the message gives the reason."""


class InteriorError(ValueError):
    """A bad interior or a bad mesh around one: names the field, its value and the allowed range."""


class MeshFileError(ValueError):
    """A mesh file that cannot be read."""


class Cancelled(Exception):  # noqa: N818 - an outcome that the caller asked for, not an error
    """The caller's `cancel` returned true; nothing was written."""
