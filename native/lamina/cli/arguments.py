# SPDX-License-Identifier: GPL-3.0-or-later
"""Arguments that several commands have in common."""

from __future__ import annotations

import argparse

from ..common.arguments import check_seed, check_threads
from ..common.errors import clipped
from ..kinds.limits import SEED, THREADS


def add_threads(command: argparse.ArgumentParser) -> None:
    command.add_argument("--threads", type=_threads, default=0, metavar="N", help="0: all (default)")


def add_seed(command: argparse.ArgumentParser) -> None:
    command.add_argument("--seed", type=_seed, default=0, metavar="N", help="of the random numbers (0)")


def check(arguments: argparse.Namespace) -> None:
    """Raises ArgumentError for a seed out of range, before a command reads any file."""
    if "seed" in arguments:
        check_seed(arguments.seed)


def _threads(text: str) -> int:
    try:
        return check_threads(int(text))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{clipped(text)}: {THREADS}") from None


def _seed(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{clipped(text)}: {SEED}") from None
