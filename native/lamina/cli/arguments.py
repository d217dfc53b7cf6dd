# SPDX-License-Identifier: GPL-3.0-or-later
"""Arguments that several commands share."""

from __future__ import annotations

import argparse

from ..common.arguments import check_seed, check_threads
from ..common.errors import clipped
from ..kinds.limits import SEED, THREADS
from ..walks.estimate import SAMPLES


def add_stack(command: argparse.ArgumentParser) -> None:
    command.add_argument("stack", metavar="STACK", help="the id of a preset, or the path of a stack's JSON file")


def add_threads(command: argparse.ArgumentParser) -> None:
    command.add_argument("--threads", type=_threads, default=0, metavar="N", help="0: all (default)")


def add_seed(command: argparse.ArgumentParser) -> None:
    command.add_argument("--seed", type=_seed, default=0, metavar="N", help="seed of the random numbers (0)")


def add_drawing(command: argparse.ArgumentParser) -> None:
    """Adds the arguments of all commands that draw samples."""
    command.add_argument("--samples", type=int, metavar="N", help=f"default {SAMPLES}")
    add_seed(command)
    add_threads(command)
    command.add_argument("--shard", type=_shard, metavar="I/N", help="run part I of N only, and write it")
    command.add_argument("-o", "--output", metavar="PART.json", help="the file for the part that --shard runs")
    command.add_argument("--json", action="store_true", help="the estimate as JSON")
    command.add_argument("--quiet", action="store_true", help="no progress")


def check(arguments: argparse.Namespace) -> None:
    """Raises ArgumentError for a seed out of range, before a command reads any file."""
    if "seed" in arguments:
        check_seed(arguments.seed)


def numbers(text: str) -> list[float]:
    """Parses numbers separated by commas."""
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise argparse.ArgumentTypeError("must be numbers separated by commas") from None


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


def _shard(text: str) -> tuple[int, int]:
    try:
        number, count = (int(part) for part in text.split("/"))
    except ValueError:
        raise argparse.ArgumentTypeError("must be I/N") from None
    return number, count
