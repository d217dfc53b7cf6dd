# SPDX-License-Identifier: GPL-3.0-or-later
"""The errors that Lamina raises on purpose. Each message is one sentence, fit to be shown to a user."""


class StackError(ValueError):
    """A stack that cannot be: names the field, its value and the allowed range."""


class LutError(ValueError):
    """A lookup table that cannot be read: truncated, foreign, or of a newer schema."""


class ExportError(ValueError):
    """An exported scattering function that cannot be read: truncated, foreign, or of a newer schema."""


class SolveError(RuntimeError):
    """A solve that missed its tolerance at the finest resolution; carries the numbers."""


class Cancelled(Exception):  # noqa: N818 - an outcome that the caller asked for, not an error
    """The caller's `cancel` said yes; nothing was written."""
