# SPDX-License-Identifier: GPL-3.0-or-later
"""Progress reports and cancellation of long work."""

from __future__ import annotations

from collections.abc import Callable

from .arguments import check_callable
from .errors import Cancelled

Progress = Callable[[float, str], None]


def stepper(work: str, progress: Progress | None, cancel: Callable[[], bool] | None) -> Progress:
    """A function step(fraction, text), fraction from 0 to 1, that calls `progress` and raises Cancelled when `cancel`
    returns true; `work` names the work in that error. Raises ArgumentError if one of them cannot be called."""
    check_callable(progress, "progress")
    check_callable(cancel, "cancel")

    def step(fraction: float, text: str) -> None:
        if cancel is not None and cancel():
            raise Cancelled(f"{work} was cancelled")
        if progress is not None:
            progress(fraction, text)

    return step


def silent(_fraction: float, _text: str) -> None:
    """A step function without progress and cancellation."""


def portion(step: Progress, first: float, last: float) -> Progress:
    """A step function for one part of the work: its range 0 to 1 is [first, last] of the whole. Only the last part says
    "Done"."""
    return lambda fraction, text: step(first + (last - first) * fraction,
                                       "" if text == "Done" and last < 1.0 else text)


def portions(step: Progress, shares: dict[str, float]) -> dict[str, Progress]:
    """Step functions for successive parts of the work, by name; `shares` of the time, of any sum > 0."""
    total, done, parts = sum(shares.values()), 0.0, {}
    for name, share in shares.items():
        parts[name] = portion(step, min(done / total, 1.0), min((done + share) / total, 1.0))
        done += share
    return parts


def time_left(seconds: float) -> str:
    """An estimate of remaining time in words, such as "about 3 minutes left"."""
    for unit, size in (("hour", 3600.0), ("minute", 60.0)):
        if seconds >= 1.5 * size:
            return f"about {round(seconds / size)} {unit}s left"
    return f"about {max(1, round(seconds))} seconds left" if seconds >= 1.5 else "about 1 second left"
