# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared by the commands that write a file and show their progress."""

from __future__ import annotations

import argparse
import os
import sys
import time
from pathlib import Path

from ..common.errors import ArgumentError


def check_writable(output: Path) -> None:
    """Raises ArgumentError if no file can be written there: checked before the work starts."""
    if output.is_dir():
        raise ArgumentError(f"{output}: is a folder, must be a file's name")
    if not os.access(output.parent, os.W_OK):
        raise ArgumentError(f"{output.parent}: not a folder that can be written to")


def check_suffix(output: Path, *suffixes: str) -> None:
    """Raises ArgumentError unless the file's name ends in one of the suffixes."""
    if output.suffix.lower() not in suffixes:
        raise ArgumentError(f"{output}: must end in {' or '.join(suffixes)}")


def progress_of(arguments: argparse.Namespace) -> Progress | None:
    """Where the command shows its progress; None with --quiet."""
    return None if arguments.quiet else Progress()


def begin_line() -> str:
    """What removes a line of progress from a terminal on standard error."""
    return "\r\033[K" if sys.stderr.isatty() else ""


class Progress:
    """A line of progress on standard error: rewritten on a terminal, otherwise repeated every two seconds."""

    EVERY = 2.0

    def __init__(self):
        self._live = sys.stderr.isatty()
        self._last = time.monotonic()

    def __call__(self, fraction: float, text: str) -> None:
        now = time.monotonic()
        if self._live:
            print(f"{begin_line()}{fraction:4.0%} {text}", end="", file=sys.stderr, flush=True)
        elif now - self._last >= self.EVERY:
            print(f"{fraction:4.0%} {text}", file=sys.stderr, flush=True)
            self._last = now

    def end(self) -> None:
        print(begin_line(), end="", file=sys.stderr, flush=True)
