# SPDX-License-Identifier: GPL-3.0-or-later
"""How long work tells its caller how far it is, and asks whether it shall stop."""

from __future__ import annotations

from collections.abc import Callable

from .arguments import check_callable
from .errors import Cancelled

Progress = Callable[[float, str], None]


def stepper(work: str, progress: Progress | None, cancel: Callable[[], bool] | None) -> Progress:
    """A function of a fraction from 0 to 1 and a text, that raises Cancelled when `cancel` says yes; `work` names
    what was cancelled. Raises ArgumentError for what cannot be called."""
    check_callable(progress, "progress")
    check_callable(cancel, "cancel")

    def step(fraction: float, text: str) -> None:
        if cancel is not None and cancel():
            raise Cancelled(f"{work} was cancelled")
        if progress is not None:
            progress(fraction, text)

    return step


def portion(step: Progress, first: float, last: float) -> Progress:
    """A stepper for one part of the work."""
    return lambda fraction, text: step(first + (last - first) * fraction, text)
