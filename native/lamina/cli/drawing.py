# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a command that draws samples and prints an estimate, or writes a part of an estimate to a file."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

from ..common.errors import ArgumentError
from ..walks.shards import save_part
from .output import check_writable, progress_of


def draw(arguments: argparse.Namespace, run: Callable, show: Callable) -> int:
    """Writes the part that `run(progress)` returns with --shard; without, gives the estimate to `show`."""
    if (arguments.shard is None) != (arguments.output is None):
        raise ArgumentError("--shard and -o go together")
    if arguments.output is not None:
        check_writable(Path(arguments.output))
    progress = progress_of(arguments)
    found = run(progress)
    if arguments.shard is not None:
        save_part(found, arguments.output)
    if progress is not None:
        progress.end()
    if arguments.shard is None:
        show(found, arguments.json)
    return 0
